# Ctrl-C in the middle of a sequence: whole files only, exit code 130, nothing else left.
$ printf '[[stage]]\ntype = "height_fog"\n' > fog.toml
$ for i in $(seq -w 1 90); do ln -s $DATA/valley_seq/valley.1001.exr s.00$i.exr; done
$ set -m; brume apply fog.toml s.####.exr -o o/ -q & job=$!
> for k in $(seq 600); do [ -e o/s.0001.exr ] && break; sleep 0.05; done
> kill -INT $job; wait $job
! brume: interrupted; ... of 90 frames written; --skip-existing makes the others
! ...Exit 130...
[130]
$ test $(ls o | wc -l) -lt 90; ls -A o | grep -v '^s.00..\.exr$'
[1]
$ for f in o/*; do frame_tool sum $f > /dev/null || echo $f; done

# The next run makes the rest.
$ rm s.00[2-8]*; brume apply fog.toml s.####.exr -o o/ -q --skip-existing; ls s.00*.exr | wc -l; for f in s.*; do test -e o/$f || echo $f; done
20
