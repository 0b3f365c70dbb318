# A frame by the truth is the frame that apply makes, within the tolerance.
$ frame_tool make a.exr width=32 height=20
$ printf '[[stage]]\ntype = "height_fog"\ndensity = 0.005\n[[stage]]\ntype = "height_fog"\nname = "ground"\ndensity = 0.02\nfalloff = 0.5\ncolor = [0.2, 0.4, 1]\n' > fog.toml
$ brume apply fog.toml a.exr -o fast.exr -q --aovs T,L
$ brume apply fog.toml a.exr -o true.exr --truth --aovs T,L
! true.exr  converged to ...
$ brume diff fast.exr true.exr --fail 1e-3 --relative 1 --ignore-attributes 'brume/*' -q
$ brume diff fast.exr a.exr --fail 1e-3 --ignore-attributes 'brume/*' -q
[3]

# Is the tolerance kept? Nothing is written.
$ brume apply fog.toml a.exr --check 200
a.exr: |dC| <= 0.001 (1 + |C|) promised, ... pixels by the truth
               pixels     worst       p99   error of S, T, L and colour where it is worst
...
  kept: ... % of what is promised (the truth is good to ... %)
$ brume apply fog.toml a.exr --check 40 --report - | grep -c '"kept": *true'
1
$ brume apply fog.toml a.exr --check 40 -q
$ echo 'version = 1' > nothing.toml; brume apply nothing.toml a.exr --check 9
a.exr: |dC| <= 0.001 (1 + |C|) promised, 0 pixels by the truth
  the scene changes nothing here

# A stage without a knob promises, too.
$ printf '[[stage]]\ntype = "relight"\n[[stage]]\ntype = "point_light"\nposition = [0, 5, 2]\n' > lit.toml
$ brume plan lit.toml a.exr | grep -A1 ^accuracy
accuracy: |dC| <= ... (white + |C|) promised, 0.001 asked for
  relight ...no knob ...promises ...

# What makes no sense.
$ brume apply fog.toml a.exr
! brume: apply: --output is required; see brume apply --help
[2]
$ brume apply fog.toml a.exr -o b.exr --check 9
! brume: apply: --check writes nothing and looks at whole frames: no --output, --truth, --region or --proxy
[2]
$ brume apply fog.toml a.exr -o b.exr --truth --proxy 2
! brume: apply: --truth renders whole frames; make a small one first
[2]
$ printf '[[stage]]\ntype = "glare"\n' > glare.toml; brume apply glare.toml a.exr -o b.exr --truth
! brume: glare: the truth is about the air; a lens stage mixes pixels after it; ...
[1]

# What the tolerance made of the knobs, and what each promises; what cannot be reached.
$ brume plan fog.toml a.exr --set tolerance=1e-4 | grep -A1 ^accuracy
accuracy: |dC| <= ... (white + |C|) promised, 0.0001 asked for
  air ...from tolerance ...promises ...
$ brume plan fog.toml a.exr --json | grep -c '"promised"'
2
$ brume apply fog.toml a.exr -o b.exr --set tolerance=1e-9
! brume: fog.toml: tolerance = 1e-09 cannot be reached; the best here is ... (air ...)
[1]
