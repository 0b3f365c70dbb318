# The same, and not the same. Exit 0, 2; what is in limits is 0.
$ frame_tool make a.exr
$ frame_tool make b.exr value=0.25
$ frame_tool make c.exr width=9
$ brume diff a.exr a.exr
$ brume diff a.exr a.exr -v
A: 64 samples, all equal
B: 64 samples, all equal
G: 64 samples, all equal
R: 64 samples, all equal
Z: 64 samples, all equal
$ brume diff a.exr b.exr --ignore-channels R
G: 40 of 64 samples differ, by at most 0.1875 at 0,7 (A 0.4375, B 0.25); rms 0.0963, ...: differ
[2]
$ brume diff a.exr b.exr --fail 100 -q
$ brume diff a.exr b.exr --fail 100 --warn 0 -q
[1]

# Limits of single channels; sizes 3, files 4.
$ brume diff a.exr b.exr --fail 100 --fail R=0 | grep -c differ$
1
$ brume diff a.exr c.exr
data window: A 8x8 at 0,0, B 9x8 at 0,0
display window: A 8x8 at 0,0, B 9x8 at 0,0
attribute worldToNDC: A m44f of 64 bytes, B m44f of 64 bytes
[3]
$ brume diff a.exr none.exr
! brume: none.exr: No such file or directory
[4]

# Sequences: a frame that one side lacks is trouble; the worst counts.
$ for f in 1 2 3; do cp a.exr s.$f.exr; cp a.exr t.$f.exr; done; cp b.exr t.2.exr
$ brume diff s.#.exr t.#.exr -q
[2]
$ brume diff s.#.exr t.#.exr -q --frames 1,3
$ rm t.3.exr; brume diff s.#.exr t.#.exr -q
! brume: t.3.exr: No such file or directory
[4]

# Measures of the whole, as JSON; a drawing that is not replaced.
$ brume diff a.exr b.exr --metric flip --fail 1 --json | grep -c '"flip"'
1
$ brume diff a.exr b.exr --fail 100 -q -o d.exr
$ brume diff a.exr b.exr --fail 100 -q -o d.exr
! brume: d.exr: exists; --overwrite replaces it
[4]

# A signed difference is numbers in an EXR; in a PNG mid grey where nothing differs, white
# and black at the largest difference, and alpha, which does not differ, hides nothing.
$ frame_tool make lo.exr value=0.25; frame_tool make hi.exr value=0.5
$ brume diff lo.exr hi.exr -q --fail 1 --picture signed -o up.exr; frame_tool at up.exr 4,7
A 0
B 0.25
G 0.25
R 0.25
Z 0
$ brume diff hi.exr lo.exr -q --fail 1 --picture signed -o down.png; frame_tool at down.png 4,7
B 0
G 0
R 0
$ frame_tool at down.png 4,0
B 0.500008
G 0.500008
R 0.500008
$ brume diff lo.exr hi.exr -q --fail 1 -o size.png; frame_tool at size.png 4,7
B 0.250004
G 0.250004
R 0.250004

$ frame_tool make nan.exr value=nan; brume diff nan.exr nan.exr --nan-equal
$ brume diff a.exr nan.exr --fail 1e9 --fail-percent 100 --ignore-channels B,G
R: 48 of 64 samples differ, by at most inf at 0,2 (A 0, B nan); 48 are NaN or infinite, the others: rms 0, mean 0; 48 (75 %) above the limit: differ
[2]
$ brume diff a.exr nan.exr --ignore-channels A,B,G,Z --json | grep -E '"(broken|numbers|rms)"'
            "broken": 48,
            "numbers": 16,
            "rms": 0,
$ brume diff a.exr b.exr --frames 1-3
! brume: diff: --frames goes with sequences
[2]
$ brume diff a.exr b.exr --metric rms --warn-percent 3
! brume: diff: --fail-percent, --warn-percent, --hard-fail and --relative go with --metric max
[2]
$ brume diff a.exr a.exr --fail R=x
! brume: diff: R=x: write a number, or CHANNEL=NUMBER
[2]
