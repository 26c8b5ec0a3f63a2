// `corsac new DIR`: a project that runs at once and shows where things go.
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "app/commands.h"
#include "app/files.h"
#include "core/file.h"

static const char main_lua[] =
    "local phys = corsac.phys\n"
    "\n"
    "function corsac.load()\n"
    "  corsac.scene.spawn{ position = { 0, -0.5, 0 }, mesh = \"box\",\n"
    "    body = { type = \"static\", shape = \"box\", size = { 20, 1, 20 } } }\n"
    "  for i = 1, corsac.param(\"n\", 20) do\n"
    "    corsac.scene.spawn{ position = { 0.1 * (i % 3), 1.1 * i, 0 }, mesh = \"sphere\",\n"
    "      body = { shape = \"sphere\", radius = 0.5 } }\n"
    "  end\n"
    "end\n"
    "\n"
    "function corsac.fixed(dt)\n"
    "  if corsac.input.isDown(\"jump\") then\n"
    "    phys.setGravity(0, 9.81, 0)\n"
    "  else\n"
    "    phys.setGravity(0, -9.81, 0)\n"
    "  end\n"
    "end\n"
    "\n"
    "corsac.expect(\"accuracy.nan\", \"==\", 0)\n";

static const char conf_lua[] = "function corsac.conf(t)\n"
                               "  t.title = \"%s\"\n"
                               "  t.size = { 1280, 720 }\n"
                               "  t.actions = { jump = \"space,up\" }\n"
                               "end\n";

static const char readme[] = "# %s\n"
                             "\n"
                             "    corsac run .                       in a window\n"
                             "    corsac run . --headless --steps 600 --metrics -\n"
                             "    corsac run . --headless --shot frame.png --set n=100\n"
                             "\n"
                             "`main.lua` holds the callbacks, `conf.lua` what is set before the "
                             "scene starts, `assets/` models,\n"
                             "images and sounds (virtual path `assets/NAME`).\n";

static const char luarc[] = "{\n"
                            "  \"runtime.version\": \"LuaJIT\",\n"
                            "  \"diagnostics.globals\": [\"corsac\"],\n"
                            "  \"workspace.library\": [\"%s/scripts/types\"]\n"
                            "}\n"; // where the stubs of this installation are

static bool put(const char *folder, const char *name, const char *format, const char *title) {
    char path[APP_PATH_MAX], text[2048];
    if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, name) >= sizeof path) {
        return core_fail("corsac new: '%.60s...' is too long", folder);
    }
    const char *hole = title ? strstr(format, "%s") : NULL;
    if (!hole) {
        return core_file_write(path, format, strlen(format));
    }
    int size =
        snprintf(text, sizeof text, "%.*s%s%s", (int)(hole - format), format, title, hole + 2);
    return core_file_write(path, text, CORE_MIN((size_t)size, sizeof text - 1));
}

int app_command_new(int argc, const char *const *argv) {
    if (argc != 1 || argv[0][0] == '-' || !argv[0][0]) {
        core_fail("corsac new: expected one folder to make, as `corsac new garden`");
        return 2;
    }
    const char *folder = argv[0], *slash = strrchr(folder, '/');
    const char *title = slash && slash[1] ? slash + 1 : folder;
    struct stat st;
    if (stat(folder, &st) == 0) {
        core_fail("corsac new: '%s' exists; choose a folder that does not", folder);
        return 2;
    }
    if (strpbrk(title, "\"\\\n")) {
        core_fail("corsac new: the folder's name '%s' must not hold quotes or backslashes", title);
        return 2;
    }
    char home[APP_PATH_MAX] = ".";
    app_home(home, sizeof home);
    bool ok = put(folder, "main.lua", main_lua, NULL) && put(folder, "conf.lua", conf_lua, title) &&
              put(folder, "README.md", readme, title) && put(folder, ".luarc.json", luarc, home) &&
              put(folder, "assets/README.md", "Models, images and sounds go here.\n", NULL);
    if (!ok) {
        return 2;
    }
    printf("Made %s. Run it: corsac run %s\n", folder, folder);
    return 0;
}
