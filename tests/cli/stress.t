# What holds is a table; -q says only what is broken. The same cases every time.
$ brume stress null --cases 2000 | head -2
null: 2048 cases against laws, 128 against the truth, ... s, seed 1; ... worlds idle
  law                                              checked  undecided  broken  worst/allowed  reproduce
$ brume stress null --cases 2000 -q
$ for i in 1 2; do brume stress relight --cases 3000 --seed 7 | sed 's/[0-9.]* s,//' > $i; done; cmp 1 2

# One case again, as a report names it; its world before the laws.
$ brume stress height_fog --case 128 | grep -c '^# ray from'
1

# Nothing is lost for want of a folder: that shows before the work.
$ brume stress null --cases 1e12 --json none/x.json
! brume: none/x.json: ...No such file or directory
[1]
$ brume stress null --cases 2000 -q --json s.json; grep -q '"reproduce"' s.json; grep -c '"undecided"' s.json; grep '"given_up"' s.json
26
    "given_up": 0,
$ ls .*.part 2>/dev/null
[2]

# Wrong words.
$ brume stress nul
! brume: stage: no stage "nul"; did you mean null?
[1]
$ brume stress null --seconds 0
! brume: stress: --seconds: Value 0 not in range 0.1 to 1000000; see brume stress --help
[2]
$ brume study a.toml a.exr --error 0
! brume: study: --error: Value 0 not in range 1e-12 to 1000000; see brume study --help
[2]
