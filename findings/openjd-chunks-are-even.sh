#!/usr/bin/env bash
# Open Job Description: chunks of an INT range with defaultTaskCount 4.
#
# "defaultTaskCount" reads as the size of a chunk, the last one being shorter: 10 numbers by 4 as 1-4, 5-8, 9-10.
# openjd makes as many chunks, but of about the same size: 1-4, 5-7, 8-10. So with other numbers the chunks begin elsewhere,
# and files that are named by chunks of two jobs overlap.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/pip" install --quiet --disable-pip-version-check "openjd-cli==0.8.0" "openjd-model==0.13.0" "openjd-sessions==0.13.0"
"$folder/environment/bin/pip" list --disable-pip-version-check 2>/dev/null | grep -i openjd

cat >"$folder/template.yaml" <<'END'
specificationVersion: jobtemplate-2023-09
extensions: [TASK_CHUNKING]
name: chunks
parameterDefinitions:
  - {name: Count, type: INT}
steps:
  - name: Print
    parameterSpace:
      taskParameterDefinitions:
        - name: Number
          type: CHUNK[INT]
          range: "1-{{Param.Count}}"
          chunks: {defaultTaskCount: 4, rangeConstraint: CONTIGUOUS}
    script:
      actions:
        onRun: {command: echo, args: ["chunk:{{Task.Param.Number}}"]}
END

chunks() {
    "$folder/environment/bin/openjd" run "$folder/template.yaml" --step Print -p "Count=$1" |
        grep -o '[[:space:]]chunk:[0-9-]*' | tr -d '[:space:]' | sed 's/chunk:/ /g; s/^ //'
}
status=0
check() {
    local seen
    seen=$(chunks "$1")
    echo "$1 numbers by 4: expected $2; seen before $3; seen now $seen"
    if [ "$seen" != "$3" ]; then status=1; fi
}
check 10 "1-4 5-8 9-10" "1-4 5-7 8-10"
check 12 "1-4 5-8 9-12" "1-4 5-8 9-12"
exit $status
