# Whatever is wrong with the input: one line that names it, exit code 1, no output.
$ frame_tool make a.exr; printf '[[stage]]\ntype = "height_fog"\n' > fog.toml
$ brume apply fog.toml none.exr -o o.exr
! brume: none.exr: no such file
[1]
$ brume apply none.toml a.exr -o o.exr
! brume: none.toml: ...
[1]
$ printf '[[stage]]\ntype = "hight_fog"\n' > typo.toml; brume apply typo.toml a.exr -o o.exr
! brume: typo.toml:2:8: no stage "hight_fog"; did you mean height_fog?
[1]
$ printf '[[stage]]\ntype = "height_fog"\ndensty = 1\n' > typo.toml; brume apply typo.toml a.exr -o o.exr
! brume: typo.toml:3:1: height_fog.densty: no such parameter; did you mean density?
[1]
$ printf '[[stage]]\ntype = "height_fog"\ndensity = -3\n' > typo.toml; brume apply typo.toml a.exr -o o.exr
! brume: typo.toml:3:...: height_fog.density = -3; allowed 0 to 1000000 per m
[1]
$ head -c 400 /dev/urandom > junk.toml; brume apply junk.toml a.exr -o o.exr
! brume: junk.toml...
[1]
$ brume apply a.exr fog.toml -o o.exr
! brume: a.exr: is no text; a scene is a TOML file; SCENE comes before IN
[1]
$ head -c 700 a.exr > cut.exr; brume apply fog.toml cut.exr -o o.exr
! brume: cut.exr: ...
[1]
$ head -c 400 /dev/urandom > junk.exr; brume apply fog.toml junk.exr -o o.exr
! brume: junk.exr: ...
[1]
$ : > empty.exr; brume apply fog.toml empty.exr -o o.exr
! brume: empty.exr: ...
[1]
$ frame_tool make flat.exr depth=none; brume apply fog.toml flat.exr -o o.exr
! brume: flat.exr: no depth channel; it has A, B, G, R; name one with [input] depth = "CHANNEL" or "FILE:CHANNEL"
[1]
$ frame_tool make lost.exr camera=0; brume apply fog.toml lost.exr -o o.exr
! brume: lost.exr: no camera, and height_fog needs to know where in the world a pixel is; write one into the file (worldToCamera and worldToNDC), or give [camera]
[1]
$ brume apply fog.toml lost.exr -o even.exr -q --set height_fog.falloff=0; rm even.exr
$ mkdir folder.exr; brume apply fog.toml a.exr -o folder.exr --overwrite
! brume: folder.exr: is a directory; write folder.exr/ to keep the names of the input
[1]
$ brume apply fog.toml folder.exr -o o.exr
! brume: folder.exr: is a directory
[1]
$ brume apply fog.toml a.exr -o /proc/o.exr
! brume: /proc/o.exr: ...
[1]
$ brume apply fog.toml a.exr -o /dev/full --overwrite
! brume: /dev/full: ...
[1]
$ frame_tool make big.exr width=99 height=99; (ulimit -f 1; brume apply fog.toml big.exr -o o.exr); rm big.exr
! brume: o.exr: File too large
$ brume apply fog.toml a.exr -o o.exr --region 100,100,8,8
! brume: ...
[1]
$ brume apply . a.exr -o o.exr
! brume: .: ...
[1]
$ brume apply fog.toml a.exr -o o.exr --plugin none.so
! brume: none.so: ...
[1]
$ BRUME_ISA=v9 brume apply fog.toml a.exr -o o.exr
! brume: BRUME_ISA...
[1]
$ ls -A | grep -v -e toml -e '^\(a\|cut\|junk\|empty\|flat\|lost\|folder\).exr$'
[1]
