$ for i in 1 2 3 5; do frame_tool make s.000$i.exr; done
$ printf '[[stage]]\ntype = "height_fog"\n' > fog.toml

# All that exist; a gap is mentioned.
$ brume apply fog.toml s.####.exr -o o.####.exr 2> said; sort said
4 frames in ... s, ... frames/s
[1/4] o.000...
[2/4] o.000...
[3/4] o.000...
[4/4] o.000...
brume: s.####.exr: no frames 4
$ ls o.*
o.0001.exr
o.0002.exr
o.0003.exr
o.0005.exr

# Frames asked for must be there, before anything runs.
$ brume apply fog.toml s.####.exr -o p.####.exr --frames 1-5
! brume: s.####.exr: no frames 4; --on-missing skip makes the others
[1]
$ ls p.* 2>/dev/null
[2]
$ brume apply fog.toml s.%04d.exr -o p.#.exr --frames 1-5x2 -q; ls p.*
p.1.exr
p.3.exr
p.5.exr
$ brume apply fog.toml s.####.exr -o q/ --frames 4,5 --on-missing skip -q; ls q
s.0005.exr
$ brume apply fog.toml s.####.exr -o q/ --frames 4 --on-missing skip
! brume: s.####.exr: no frames 4
[1]
$ brume apply fog.toml s.####.exr -o q/ --frames 5-1
! brume: --frames...
[2]

# A restart makes what is missing only.
$ rm o.0003.exr; brume apply fog.toml s.####.exr -o o.####.exr
! brume: s.####.exr: no frames 4
! brume: o.0001.exr: exists, as do 2 more; --overwrite replaces, --skip-existing leaves what exists
[1]
$ brume apply fog.toml s.####.exr -o o.####.exr --skip-existing
! brume: s.####.exr: no frames 4
! 3 of 4 outputs exist and stay
! o.0003.exr  ... s

# Several frames into one file: no.
$ brume apply fog.toml s.####.exr -o o.exr
! brume: s.####.exr: no frames 4
! brume: -o o.exr: 4 frames into one file; write a frame number as ####, or a folder ending in /
[2]
$ mkdir a b; cp s.0001.exr a; cp s.0001.exr b; brume apply fog.toml a/s.0001.exr b/s.0001.exr -o c/
! brume: -o c/: a/s.0001.exr and b/s.0001.exr would both be written to c/s.0001.exr
[2]
$ brume apply fog.toml none.####.exr -o o.####.exr
! brume: none.####.exr: no frame of it exists
[1]

# One frame is broken: the others are made, and the exit code says so.
$ head -c 300 s.0002.exr > cut && mv cut s.0002.exr
$ brume apply fog.toml s.####.exr -o r.####.exr --frames 1-3 -q
! brume: s.0002.exr: ...
[3]
$ ls r.*
r.0001.exr
r.0003.exr

# Keyframed values follow the frame's number.
$ printf '[[stage]]\ntype = "height_fog"\ndensity = { frames = [1, 3], values = [0.0, 0.02] }\n' > keys.toml
$ brume plan keys.toml s.0001.exr | grep height_fog
  height_fog  left out  density is 0
$ brume plan keys.toml s.0003.exr | grep height_fog
  height_fog  runs ...
...
