$ frame_tool make a.exr
$ printf '[[stage]]\ntype = "height_fog"\n' > fog.toml
$ brume apply fog.toml a.exr -o b.exr
! b.exr  ... s
$ brume apply fog.toml a.exr -o b.exr
! brume: b.exr: exists; --overwrite replaces, --skip-existing leaves what exists
[1]
$ brume apply fog.toml a.exr -o b.exr -q --overwrite
$ brume apply fog.toml a.exr -o b.exr --skip-existing
! 1 of 1 outputs exist and stay
! Nothing to do

# Over itself: never.
$ brume apply fog.toml a.exr -o a.exr --overwrite
! brume: -o a.exr: is an input; write somewhere else
[2]

# A folder, and one that is not there yet.
$ mkdir there; brume apply fog.toml a.exr -o there
! brume: there: is a directory; write there/ to keep the names of the input
[1]
$ brume apply fog.toml a.exr -o there/ -q; brume apply fog.toml a.exr -o new/deep/c.exr -q; ls there new/deep
new/deep:
c.exr

there:
a.exr

# The same bits from any number of threads, and in a region.
$ frame_tool make big.exr width=97 height=61
$ brume apply fog.toml big.exr -o one.exr -q --threads 1; brume apply fog.toml big.exr -o four.exr -q --threads 4
$ cmp one.exr four.exr
$ brume apply fog.toml big.exr -o crop.exr -q --region 10,20,50,30
$ diff <(frame_tool sum one.exr 10,20,50,30) <(frame_tool sum crop.exr)

# Nothing to change: nothing changes.
$ echo 'version = 1' > nothing.toml; brume apply nothing.toml big.exr -o same.exr -q
$ diff <(frame_tool sum big.exr) <(frame_tool sum same.exr)

# Values from the command line; the layers; the compression.
$ brume apply fog.toml a.exr -o t.exr -q --aovs T,L --compression piz --set height_fog.density=0.01
$ brume info t.exr | head -5
t.exr
  data 8 x 8 at (0, 0), display 8 x 8 at (0, 0), piz
  (base)  float  Z
  (base)  half   A B G R
  L       float  B G R

# A lossy compression is said: what loses, and how not to.
$ frame_tool make dwa.exr compression=dwaa
$ brume plan fog.toml dwa.exr | grep compression
  compression: dwaa (the file's) loses a little of B, G, R where a pixel changes; output.compression = "zip" loses nothing
$ brume apply fog.toml dwa.exr -o d1.exr -q
$ brume apply fog.toml dwa.exr -o d2.exr --aovs T
! d2.exr  ... s
! brume: d2.exr: the file's compression is lossy, for the layers too (T.R, T.G, T.B); --compression zip keeps their values
$ brume apply fog.toml dwa.exr -o d4.exr --aovs T --truth
! d4.exr  converged to ...
! brume: d4.exr: the file's compression is lossy, for the layers too (T.R, T.G, T.B); --compression zip keeps their values
$ brume apply fog.toml dwa.exr -o d5.exr --truth --report r.json
! brume: apply: --report is of the fast way; --truth says what it reached
[2]
$ brume apply fog.toml dwa.exr -o d3.exr --aovs T --compression zip
! d3.exr  ... s
$ brume plan fog.toml dwa.exr --set output.compression=b44 | grep compression
  compression: b44 ([output]) loses a little of A, B, G, R where a pixel changes; output.compression = "zip" loses nothing
$ brume plan nothing.toml dwa.exr | grep compression
[1]

$ brume apply fog.toml a.exr -o no.exr --set height_fog.densty=1
! brume: --set height_fog.densty: no such parameter; did you mean density?
[2]
$ brume apply fog.toml a.exr -o no.exr --set height_fog.density=-1
! brume: --set: height_fog.density = -1; allowed 0 to 1000000 per m
[2]
$ brume apply fog.toml a.exr -o no.exr --aovs T,X
! brume: fog.toml: output.aovs: no layer X; ...
[1]

# What it took, as JSON.
$ brume apply fog.toml a.exr -o r.exr -q --report - | head -1
{
$ brume apply fog.toml a.exr -o r.exr -q --overwrite --report r.json; test -s r.json
$ ls *.part .*.part 2>/dev/null
[2]

# Where it came from stands in the file.
$ brume info b.exr | grep -o '^  brume/[a-z]*'
  brume/report
  brume/scene
  brume/version
