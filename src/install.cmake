# What `cmake --install` puts where: program, libbrume with its headers and CMake package, modules (brume_plugin),
# completion, man page.
include(CMakePackageConfigHelpers)

install(TARGETS brume_program RUNTIME)
install(FILES ${CMAKE_BINARY_DIR}/brume.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${CMAKE_BINARY_DIR}/brume.bash
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME brume)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The headers that a program (library first) or a plugin needs; they include one another by these paths.
foreach(header
    plugin.h
    num/error.h
    image/image.h image/io.h
    params/params.h params/describe.h
    scene/scene_file.h scene/scene_file_sections.h scene/color_space.h scene/frames.h scene/view.h scene/world.h
    air/air.h
    stage/stage.h stage/needs.h stage/fog.h stage/footprint.h stage/module.h stage/registry.h
    pipeline/pipeline.h pipeline/frame_file.h pipeline/probe.h
    picture/picture.h)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES src/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brume/${folder})
endforeach()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/brume)
install(TARGETS brume EXPORT brume)
install(EXPORT brume FILE brumeTargets.cmake NAMESPACE brume:: DESTINATION ${package})
set(needed TBB fmt glm tomlplusplus Threads)
if(BRUME_LINK_PLUGINS)
  list(PREPEND needed Imath OpenEXR)
endif()
list(JOIN needed " " needed)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/brumeConfig.cmake CONTENT [[
include(CMakeFindDependencyMacro)
foreach(needed @needed@)
  find_dependency(${needed})
endforeach()
include(${CMAKE_CURRENT_LIST_DIR}/brumeTargets.cmake)
]] @ONLY)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/brumeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/brumeConfig.cmake ${CMAKE_BINARY_DIR}/brumeConfigVersion.cmake
        DESTINATION ${package})
