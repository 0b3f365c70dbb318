# What the fog of a small frame costs, and how far off each method is.
$ printf '[[stage]]\ntype = "height_fog"\ndensity = 0.01\n' > fog.toml
$ brume study fog.toml $DATA/edges_point_480x270.exr --seconds 1 --repeats 3
height_fog: ... rays; the truth: ...
  method ...
  brume ...any tolerance ...
  Wenzel 2007, ...as published ...
  even steps ...1 step ...
  ...2 steps ...
...

# Three files, none of which is replaced unasked; the page needs nothing else.
$ brume study fog.toml $DATA/edges_point_480x270.exr --seconds 1 --repeats 3 -o s/fog.html && ls s
fog.html
study.csv
study.json
$ head -1 s/study.csv | cut -d, -f1-5
subject,kind,method,setting,once_s
$ grep -c '^"height_fog",source' s/study.csv
1
$ grep -c '"command": "brume study fog.toml' s/study.json
1
$ grep -c '<svg' s/fog.html
1
$ brume study fog.toml $DATA/edges_point_480x270.exr -o s/fog.html
! brume: s/fog.html: exists; --overwrite replaces it
[1]
$ rm s/fog.html; brume study fog.toml $DATA/edges_point_480x270.exr -o s/fog.html
! brume: s/study.csv: exists; --overwrite replaces it
[1]

# Settings by time, and by error.
$ brume study fog.toml $DATA/edges_point_480x270.exr --seconds 1 --repeats 3 --budget 10s --error 1e-5
within 10s: any tolerance: ... for the frame, worst error ...
  (the scene as it is)
error 1e-05: any tolerance: ... for the frame, worst error ...
  (the scene as it is)
$ brume study fog.toml $DATA/edges_point_480x270.exr --seconds 1 --repeats 3 --budget 1us
within 1us: nothing; the nearest is any tolerance: ...
[1]
$ brume study fog.toml $DATA/edges_point_480x270.exr --budget soon
! brume: study: --budget soon: write a time, as 0.5s or 20ms
[2]

# Nothing to study is said.
$ brume study fog.toml $DATA/edges_point_480x270.exr --set height_fog.density=0
! brume: ...edges_point_480x270.exr: no stage does anything to this frame; brume plan says why
[1]
