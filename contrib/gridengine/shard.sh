#!/bin/bash
# Renders one shard of a plan: the line of the file of commands with the number of this array task.
#
# Gridengine sends no SIGTERM. With -notify it warns by SIGUSR1 before it suspends a task and by SIGUSR2 before it kills
# one. The command then saves its shard, and the task goes back to the queue if the shard has grown; it does so after TURN
# seconds, too. The soft limit s_rt warns once: a task that meets it again is ended, whatever its exit code.
#$ -S /bin/bash
#$ -N translucid
#$ -cwd
#$ -j y
#$ -r y
#$ -notify
set -uo pipefail

eval "command=($(sed -n "${SGE_TASK_ID}p" "$1"))"
# The last word of a plan's command
shard=${command[-1]}
case " ${command[*]} " in
*" --threads "* | *" --threads="*) ;;
*) command+=(--threads "${NSLOTS:-1}") ;;
esac

version() { stat --format "%i %y" "$shard" 2>/dev/null; }
before=$(version)
# The warnings reach this shell, too, where they end a wait
trap : USR1 USR2
"${command[@]}" --resume --wait 600 &
child=$!
timer=
if [ -n "${TURN:-}" ]; then
    (sleep "$TURN" && kill -USR1 "$child") &
    timer=$!
fi
while kill -0 "$child" 2>/dev/null; do
    wait "$child"
done
wait "$child"
code=$?
if [ -n "$timer" ]; then kill "$timer" 2>/dev/null; fi

# 138, 140: warned before the end. 99: gridengine runs the task again
case $code in
138 | 140) if [ "$(version)" != "$before" ]; then exit 99; fi ;;
esac
exit "$code"
