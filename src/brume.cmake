# How brume's targets are declared: brume_folder, brume_plugin, brume_test. Sources are listed, never globbed.

# What every target of ours is compiled with.
add_library(brume_flags INTERFACE)
target_compile_features(brume_flags INTERFACE cxx_std_20)
target_compile_options(brume_flags INTERFACE -Wall -Wextra -Wshadow -Wno-psabi
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # gcc 12 reports std::string's own memcpy (its bug 105329)
  # Contraction is pinned: off everywhere but in kernels (see brume_isa_sources), so that host code gives the same bits
  # whatever the compiler's default. (Options of a linked target come after a target's own: without the condition off
  # would win there too.)
  $<$<NOT:$<BOOL:$<TARGET_PROPERTY:BRUME_KERNELS>>>:-ffp-contract=off>)
target_include_directories(brume_flags INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
if(BRUME_SANITIZE)
  set(sanitizers -fsanitize=${BRUME_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(brume_flags INTERFACE
    $<$<NOT:$<BOOL:$<TARGET_PROPERTY:BRUME_UNSANITIZED>>>:${sanitizers}>)
  target_link_options(brume_flags INTERFACE -fsanitize=${BRUME_SANITIZE})
endif()

set(BRUME_ISAS v2 v3 v4)

# brume_isa_sources(<target> <file>...): compiles each file once per instruction set (x86-64-v2, v3, v4) and adds the
# objects to <target>. The file sees BRUME_ISA (v2, v3 or v4); num/isa.h turns it into an inline namespace. These files
# hold kernels only and are optimised in every build type (at -O0 their std:: symbols would leak as weak ones).
function(brume_isa_sources target)
  foreach(isa IN LISTS BRUME_ISAS)
    set(objects ${target}_${isa})
    add_library(${objects} OBJECT ${ARGN})
    target_link_libraries(${objects} PRIVATE brume_flags)
    set_target_properties(${objects} PROPERTIES BRUME_KERNELS ON)
    if(target MATCHES "^brume_(air|study|plugin_.*)$")  # arithmetic alone; with sanitizers minutes and 2 GB a file
      set_target_properties(${objects} PROPERTIES BRUME_UNSANITIZED ON)
      if(BRUME_SANITIZE)
        target_compile_options(${objects} PRIVATE -g0)
      endif()
    endif()
    target_compile_definitions(${objects} PRIVATE BRUME_ISA=${isa})
    target_compile_options(${objects} PRIVATE -march=x86-64-${isa} -O3 -ffp-contract=fast)
    if(isa STREQUAL v4)
      target_compile_options(${objects} PRIVATE -mprefer-vector-width=512)
    endif()
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
  endforeach()
endfunction()

# brume_sealed_isa_sources(<target> <table> <file>...): the same for files that instantiate other people's templates, which
# are in no namespace of ours: of each instruction set all symbols are made local but those that hold the name <table>,
# so that the linker cannot take one's std::vector for another's.
function(brume_sealed_isa_sources target table)
  foreach(isa IN LISTS BRUME_ISAS)
    set(objects ${target}_sealed_${isa})
    add_library(${objects} OBJECT ${ARGN})
    target_link_libraries(${objects} PRIVATE brume_flags)
    target_compile_definitions(${objects} PRIVATE BRUME_ISA=${isa})
    target_compile_options(${objects} PRIVATE -march=x86-64-${isa} -O3 $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
    set(sealed ${CMAKE_CURRENT_BINARY_DIR}/${objects}.o)
    add_custom_command(OUTPUT ${sealed}
      COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${sealed} $<TARGET_OBJECTS:${objects}>
      COMMAND ${CMAKE_OBJCOPY} --wildcard --keep-global-symbol=*${table}* ${sealed}
      DEPENDS $<TARGET_OBJECTS:${objects}> COMMAND_EXPAND_LISTS VERBATIM)
    add_custom_target(${objects}_object DEPENDS ${sealed})
    set_property(TARGET ${target} APPEND PROPERTY BRUME_SEALED ${sealed})
    set_property(TARGET ${target} APPEND PROPERTY BRUME_SEALED_BY ${objects}_object)
  endforeach()
endfunction()

# brume_add_objects(<target> <library>): the library's objects, those per instruction set too (TARGET_OBJECTS leaves out objects
# that came from elsewhere).
function(brume_add_objects target library)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${library}>)
  foreach(isa IN LISTS BRUME_ISAS)
    if(TARGET ${library}_${isa})
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:${library}_${isa}>)
    endif()
  endforeach()
  get_target_property(sealed ${library} BRUME_SEALED)
  if(sealed)
    get_target_property(by ${library} BRUME_SEALED_BY)
    target_sources(${target} PRIVATE ${sealed})
    add_dependencies(${target} ${by})
  endif()
endfunction()

# brume_folder(<name> SOURCES ... [ISA ...] [LINK ...]): one folder of the library, target brume_<name>; its objects
# become part of libbrume.
function(brume_folder name)
  cmake_parse_arguments(F "" "" "SOURCES;ISA;LINK" ${ARGN})
  add_library(brume_${name} OBJECT ${F_SOURCES})
  target_link_libraries(brume_${name} PUBLIC brume_flags ${F_LINK})
  if(F_ISA)
    brume_isa_sources(brume_${name} ${F_ISA})
  endif()
  set_property(GLOBAL APPEND PROPERTY BRUME_FOLDERS brume_${name})
endfunction()

# brume_plugin(<name> SOURCES ... [ISA ...] [SEALED <table> ...] [LINK ...] [STAGES ...]): one plugin folder. A plugin is objects, made into
# the module plugins/brume_<name>.so, or linked into a program (brume_link_plugins). STAGES names the stages it carries where
# they are not just <name>; each gets a name of its own to be found by, and a module that has no stage of its own name is just
# <name>.so, so that it is not taken for one. -DBRUME_PLUGIN_<NAME>=OFF leaves it out.
#
# Every plugin's source defines brume_plugin (src/plugin.h). Several in one program need an entry each, so the objects are
# compiled with that one word replaced by brume_plugin_<name>; a module adds one line of C that exports brume_plugin again.
# The same objects serve both.
function(brume_plugin name)
  cmake_parse_arguments(P "" "" "SOURCES;ISA;SEALED;LINK;STAGES" ${ARGN})
  string(TOUPPER ${name} upper)
  option(BRUME_PLUGIN_${upper} "Build the ${name} plugin" ON)
  if(NOT BRUME_PLUGIN_${upper})
    return()
  endif()
  add_library(brume_plugin_${name} OBJECT ${P_SOURCES})
  target_link_libraries(brume_plugin_${name} PUBLIC brume_flags ${P_LINK})
  target_compile_definitions(brume_plugin_${name} PRIVATE brume_plugin=brume_plugin_${name}
                                                          BRUME_PLUGIN_VERSION="${PROJECT_VERSION}")
  if(P_ISA)
    brume_isa_sources(brume_plugin_${name} ${P_ISA})
  endif()
  if(P_SEALED)
    brume_sealed_isa_sources(brume_plugin_${name} ${P_SEALED})
  endif()
  set_property(GLOBAL APPEND PROPERTY BRUME_PLUGINS ${name})
  if(NOT P_STAGES)
    set(P_STAGES ${name})
  endif()
  set_property(GLOBAL APPEND PROPERTY BRUME_STAGES ${P_STAGES})
  if(BRUME_LINK_PLUGINS)
    return()
  endif()
  set(entry ${CMAKE_CURRENT_BINARY_DIR}/brume_${name}_entry.c)
  file(CONFIGURE OUTPUT ${entry} CONTENT [[#include "plugin.h"
const brume_plugin_info* brume_plugin_@name@(void);
BRUME_EXPORT const brume_plugin_info* brume_plugin(void);
const brume_plugin_info* brume_plugin(void) { return brume_plugin_@name@(); }
]] @ONLY)
  set(file brume_${name})
  if(NOT name IN_LIST P_STAGES)
    set(file ${name})
  endif()
  add_library(brume_module_${name} MODULE ${entry})
  brume_add_objects(brume_module_${name} brume_plugin_${name})
  target_link_libraries(brume_module_${name} PRIVATE brume_flags ${P_LINK})
  set_target_properties(brume_module_${name} PROPERTIES PREFIX "" OUTPUT_NAME ${file}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/plugins)
  install(TARGETS brume_module_${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/brume)
  foreach(stage IN LISTS P_STAGES)
    if(NOT stage STREQUAL name)
      add_custom_command(TARGET brume_module_${name} POST_BUILD
        COMMAND ${CMAKE_COMMAND} -E create_symlink ${file}.so ${CMAKE_BINARY_DIR}/plugins/brume_${stage}.so)
      install(FILES ${CMAKE_BINARY_DIR}/plugins/brume_${stage}.so DESTINATION ${CMAKE_INSTALL_LIBDIR}/brume)
    endif()
  endforeach()
endfunction()

# brume_link_plugins(<target> [<name>...]): links these plugins (default: all built so far) into a program or library, which
# then finds their stages without opening a file (src/stage/registry.h).
function(brume_link_plugins target)
  set(names ${ARGN})
  if(NOT names)
    get_property(names GLOBAL PROPERTY BRUME_PLUGINS)
  endif()
  set(declarations "")
  set(rows "")
  foreach(name IN LISTS names)
    string(APPEND declarations "extern \"C\" const brume_plugin_info* brume_plugin_${name}(void);\n")
    string(APPEND rows "const brume::LinkedPlugin ${name}_linked{\"${name}\", brume_plugin_${name}};\n")
    brume_add_objects(${target} brume_plugin_${name})
    target_link_libraries(${target} PRIVATE $<TARGET_PROPERTY:brume_plugin_${name},LINK_LIBRARIES>)
  endforeach()
  set(table ${CMAKE_CURRENT_BINARY_DIR}/${target}_linked_plugins.cpp)
  file(CONFIGURE OUTPUT ${table} CONTENT "#include \"stage/registry.h\"\n${declarations}namespace {\n${rows}}\n" @ONLY)
  target_sources(${target} PRIVATE ${table})
endfunction()

# brume_test(<name> SOURCES ... [LINK ...]): one GoogleTest program test_<name>, run by ctest as a whole.
function(brume_test name)
  if(NOT BRUME_WITH_TESTS)
    return()
  endif()
  cmake_parse_arguments(T "" "" "SOURCES;LINK" ${ARGN})
  add_executable(test_${name} ${T_SOURCES})
  target_link_libraries(test_${name} PRIVATE brume_flags ${T_LINK} GTest::gtest GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE BRUME_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                  BRUME_BUILD_DIR="${CMAKE_BINARY_DIR}")
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${CMAKE_BINARY_DIR})
endfunction()
