E=/tmp/wt5/build/bench/apps/cli/eventide
for i in 1 2 3; do for wp in ${WPS:-100000 700 500}; do echo -n "WP $wp "; WP=$wp $E bench --stages --sizes ${S:-640x480} --models ${M:-default} --precisions bf16 --lookahead 0 --repetitions ${R:-40} 2>/dev/null | grep -E "fast, bf" | cut -c40-80; done; done
