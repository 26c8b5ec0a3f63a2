// corsac-apidoc markdown|stubs: the reference page or the editor stubs to stdout (`make docs`).
#include "script/bind.h"

#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
    bool stubs = argc == 2 && strcmp(argv[1], "stubs") == 0;
    if (argc != 2 || (!stubs && strcmp(argv[1], "markdown") != 0)) {
        fprintf(stderr, "usage: corsac-apidoc markdown|stubs\n");
        return 2;
    }
    char *text = stubs ? bind_docs_stubs() : bind_docs_markdown();
    fputs(text, stdout);
    core_free(text);
    return 0;
}
