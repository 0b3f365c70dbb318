$ brume stages
...
height_fog ...
...
$ brume stages height_fog | head -5
height_fog (air): Fog whose density falls exponentially with height.
from ...

parameter ...default ...allowed...
density ...0 to 1000000 per m...
$ brume stages hight_fog
! brume: stage: no stage "hight_fog"; did you mean height_fog?
[1]
$ brume stages --names | grep -c height_fog
1
$ brume stages height_fog --schema | grep -c '"density"'
1
$ brume stages --json | grep -c '"name": "height_fog"'
1
$ brume stages --schema
! brume: stages: --schema needs the name of a stage
[2]

# What the shell completes.
$ brume --completion > c; . ./c; COMP_WORDS=(brume ap); COMP_CWORD=1; _brume; echo ${COMPREPLY[@]}
apply
$ brume --completion > c; . ./c; COMP_WORDS=(brume apply --over); COMP_CWORD=2; _brume; echo ${COMPREPLY[@]}
--overwrite
$ brume --completion > c; . ./c; COMP_WORDS=(brume apply --on-missing s); COMP_CWORD=3; _brume; echo ${COMPREPLY[@]}
stop skip
$ brume --completion > c; . ./c; COMP_WORDS=(brume stages height); COMP_CWORD=2; _brume; echo ${COMPREPLY[@]}
height_fog
$ brume --man | head -1
.TH BRUME 1 "" "brume 0.1.0" "User Commands"
