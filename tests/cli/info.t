$ frame_tool make a.exr; brume info a.exr
a.exr
  data 8 x 8 at (0, 0), display 8 x 8 at (0, 0), zip
  (base)  float  Z
  (base)  half   A B G R
depth: Z (EXR's own name for depth)
  17.78 to 316.228, median ...; background 25 % of the pixels (written as 1e+10)
  scene units; taken as planar unless [input] depth_kind says otherwise
camera: perspective from worldToCamera...
  at (0, 0, 2), looking along (0, 1, 0), up (0, 0, 1), 90 degrees wide
attributes
...
$ frame_tool make flat.exr depth=none camera=0; brume info flat.exr
flat.exr
  data ...
  (base)  half  A B G R
depth: no channel is named like depth; [input] depth names one
camera: none; a scene's [camera] can give one
...
$ frame_tool make n.exr depth=nan; brume info n.exr | grep -A3 ^depth
depth: Z (EXR's own name for depth)
  0 to 0, median 0; background 100 % of the pixels
  no pixel has a depth
  64 pixels are NaN: background
$ frame_tool make n.exr depth=0.7; brume info n.exr | grep looks
  looks normalised (all within 0..1): set [input] depth_kind = "normalised", depth_near and depth_far
$ brume info none.exr a.exr | head -1
a.exr
! brume: none.exr: No such file or directory
$ brume info none.exr
! brume: none.exr: No such file or directory
[1]
$ brume info a.exr --json | grep -c '"channel": "Z"'
1
