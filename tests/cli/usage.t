# Command lines that make no sense: one line, exit code 2, nothing done.
$ brume
! brume: what shall it do? see brume --help
[2]
$ brume aply fog.toml a.exr -o b.exr
! brume: aply: no such command; did you mean apply?
[2]
$ brume apply fog.toml a.exr -o b.exr --overwrit
! brume: apply: --overwrit: no such option; did you mean --overwrite?
[2]
$ brume apply fog.toml a.exr
! brume: apply: --output is required; see brume apply --help
[2]
$ brume apply fog.toml a.exr -o b.exr --region 1,2,3
! brume: apply: --region: "1,2,3" is no region; write x,y,width,height in pixels, e.g. 960,540,512,512; see brume apply --help
[2]
$ brume apply fog.toml a.exr -o b.exr --proxy 0
! brume: apply: --proxy: ...; see brume apply --help
[2]
$ brume apply fog.toml a.exr -o b.exr --on-missing ignore
! brume: apply: --on-missing: ignore not in {stop,skip}; see brume apply --help
[2]
$ brume apply fog.toml a.exr -o b.exr --overwrite --skip-existing
! brume: --overwrite and --skip-existing: one or the other
[2]
$ brume --version
brume 0.1.0
$ brume --help | head -3
brume gives a rendered frame its air: ...
...
$ brume apply --help | head -1
usage: brume apply SCENE IN... -o OUT [options]
$ brume help | head -1
brume gives a rendered frame its air: ...
$ brume help apply | head -1
usage: brume apply SCENE IN... -o OUT [options]
$ brume help aply
! brume: help: no such command; see brume --help
[2]
$ brume apply -o --help | head -1
usage: brume apply SCENE IN... -o OUT [options]
