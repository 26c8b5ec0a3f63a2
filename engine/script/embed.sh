#!/bin/sh
# Writes Lua files as one C table: script_embedded_files[] = {name, bytes, size}.
# Uses od and sed alone, which every Debian has.
echo '#include "script/embedded.h"'
i=0
for f; do
    echo "static const unsigned char file_$i[] = {"
    od -An -v -tx1 "$f" | sed 's/ \(..\)/0x\1,/g'
    echo "0};"
    i=$((i + 1))
done
echo "const script_embedded_file script_embedded_files[] = {"
i=0
for f; do
    echo "{\"$(basename "$f")\", (const char *)file_$i, sizeof file_$i - 1},"
    i=$((i + 1))
done
echo "{0}};"
