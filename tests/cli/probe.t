# Even fog of 0.01 per metre: T = exp(-0.01 d), L = 1 - T.
$ printf '[[stage]]\ntype = "height_fog"\ndensity = 0.01\nfalloff = 0\ncolor = 1\n' > even.toml
$ printf 'ox,oy,oz,dx,dy,dz,distance\n0,0,0,0,3,0,100\n0,0,0,1,0,0,0\n0,0,0,0,0,1,inf\n' > rays.csv
$ brume probe even.toml rays.csv
ox,oy,oz,dx,dy,dz,distance,T_r,T_g,T_b,L_r,L_g,L_b
0,0,0,0,3,0,100,0.36787...,0.36787...,0.36787...,0.63212...,0.63212...,0.63212...
0,0,0,1,0,0,0,1,1,1,0,0,0
0,0,0,0,0,1,inf,0,0,0,1,1,1
$ brume probe even.toml - < rays.csv | tail -1
0,0,0,0,0,1,inf,0,0,0,1,1,1

# Colours are the frame's own unless the scene says otherwise.
$ printf 'colorspace = "srgb"\n' | cat - even.toml | sed 's/color = 1/color = 0.5/' > srgb.toml
$ brume probe srgb.toml rays.csv | tail -1
0,0,0,0,0,1,inf,0,0,0,0.214041...,0.214041...,0.214041...
$ brume probe --set colorspace=acescgg even.toml rays.csv
! brume: --set: colorspace = "acescgg"; did you mean acescg? allowed: "frame", "rec709", "srgb", "rec2020", "p3d65", "acescg", "aces2065-1"
[2]

# A column of colour passes through; a planet's surface costs no precision: the same ray
# 6.4e6 m up and at the origin, through fog that is anchored there.
$ printf 'ox,oy,oz,dx,dy,dz,distance,r,g,b\n1e6,2e6,6400000,0,1,-0.1,200,.1,.2,.3\n' > far.csv
$ printf '[[stage]]\ntype = "height_fog"\ndensity = 0.01\nheight = 6400000\n' > far.toml
$ printf 'ox,oy,oz,dx,dy,dz,distance,r,g,b\n0,0,0,0,1,-0.1,200,.1,.2,.3\n' > near.csv
$ printf '[[stage]]\ntype = "height_fog"\ndensity = 0.01\n' > near.toml
$ diff <(brume probe far.toml far.csv | cut -d, -f4-) <(brume probe near.toml near.csv | cut -d, -f4-)

# What is wrong, and in which line.
$ printf 'ox,oy\n1,2\n' | brume probe even.toml -
! brume: standard input:1: the header is not a table of rays; write ox,oy,oz,dx,dy,dz,distance or ox,oy,oz,dx,dy,dz,distance,r,g,b
[1]
$ printf 'ox,oy,oz,dx,dy,dz,distance\n\n0,0,0,0,1,0\n' > bad.csv; brume probe even.toml bad.csv
! brume: bad.csv:3: 6 values; the header names 7
[1]
$ printf 'ox,oy,oz,dx,dy,dz,distance\n0,0,0,0,1,x,5\n' > bad.csv; brume probe even.toml bad.csv
! brume: bad.csv:2: dz = "x" is no number
[1]
$ printf 'ox,oy,oz,dx,dy,dz,distance\n0,0,0,0,0,0,5\n' > bad.csv; brume probe even.toml bad.csv
! brume: bad.csv:2: the direction is zero
[1]
$ printf 'ox,oy,oz,dx,dy,dz,distance\n0,0,0,0,1,0,-5\n' > bad.csv; brume probe even.toml bad.csv
! brume: bad.csv:2: distance = -5; 0 to inf
[1]
$ printf 'ox,oy,oz,dx,dy,dz,distance\n0,0,nan,0,1,0,5\n' > bad.csv; brume probe even.toml bad.csv
! brume: bad.csv:2: oz = nan
[1]
$ : > empty.csv; brume probe even.toml empty.csv
! brume: empty.csv: is empty; its first line is ox,oy,oz,dx,dy,dz,distance
[1]

# By the truth: the same physics by another route, and how far it may be off.
$ brume probe --truth even.toml rays.csv
ox,oy,oz,dx,dy,dz,distance,T_r,T_g,T_b,L_r,L_g,L_b,T_error,L_error
0,0,0,0,3,0,100,0.36787944117...,0.36787944117...,0.36787944117...,0.6321205588...,0.6321205588...,0.6321205588...
0,0,0,1,0,0,0,1,1,1,0,0,0,0,0
0,0,0,0,0,1,inf,...

# Noise is where it is, from whichever end one looks: 3 m of it from 30 m away, and from their other end.
$ printf '[[stage]]\ntype = "noise_fog"\ndensity = 0.05\nfalloff = 0\nsize = 20\ncolor = 1\n' > noise.toml
$ printf 'ox,oy,oz,dx,dy,dz,distance\n0,0,1,0,1,0,30\n0,0,1,0,1,0,33\n0,33,1,0,-1,0,3\n' > ends.csv
$ brume probe noise.toml ends.csv | awk -F, 'NR > 1 { T[NR - 1] = $8 } END { d = T[2] / T[1] - T[3]; print (T[3] < 0.9 && d * d < 1e-6) }'
1
