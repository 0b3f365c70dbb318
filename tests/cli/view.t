$ frame_tool make a.exr width=64 height=32; brume view a.exr -o a.png -v
! a.png  64 x 32
$ brume view a.exr -o a.png
! brume: a.png: exists; --overwrite replaces it
[1]
$ brume view a.exr -o .
! brume: .: is a directory
[1]
$ brume view a.exr -o a.xyz
! brume: a.xyz: ...
[1]
$ brume view a.exr --layer T -o t.png
! brume: a.exr: no layer T; it has A, B, G, R, Z
[1]

# Depth in false colour, with its range below; a layer by its name behind a colon.
$ brume view a.exr:Z -o z.png -v
! z.png  64 x 48
$ brume view a.exr --layer Z --range 10,500 -o z2.png; cmp -s z.png z2.png
[1]
$ brume view a.exr --layer Z --range 5 -o z3.png
! brume: view: --range 5: write A,B with A below B
[2]

# Several: side by side, as wide as asked for, in columns, with their names.
$ brume view a.exr a.exr:Z a.exr:A -o sheet.png --width 320 -v
! sheet.png  642 x 354
$ brume view a.exr a.exr -o row.png --columns 2 --label one --label two -v
! row.png  130 x 48

# On the screen is what the numbers say: linear 0.5 is 188 of 255 in sRGB.
$ frame_tool make grey.exr value=0.5; brume view grey.exr --curve linear -o grey.png; frame_tool at grey.png 4,6
B 0.737255
G 0.737255
R 0.737255

# A picture for the screen stays as it is.
$ brume view grey.png -o again.png; diff <(frame_tool sum grey.png) <(frame_tool sum again.png)
