# LuaJIT reaches these functions of the C library through the engine (libc.c), so that Lua computes
# the same bits on every machine.
WRAP := pow sin cos tan asin acos atan atan2 exp log log2 log10 sinh cosh tanh fmod syscall

# The Lua half of the API travels inside the library: scripts/corsac/*.lua as C arrays.
EMBED_LUA := $(wildcard scripts/corsac/*.lua)
LIB_OBJ += $(OBJ)/gen/corsac_lua.o
$(GEN)/corsac_lua.c: $(EMBED_LUA) engine/script/embed.sh
	@mkdir -p $(@D); sh engine/script/embed.sh $(EMBED_LUA) >$@.new; mv $@.new $@
$(OBJ)/gen/corsac_lua.o: $(GEN)/corsac_lua.c

# The program that writes docs/api.md and the editor stubs.
$(OUT)/corsac-apidoc: $(OBJ)/tools/apidoc/apidoc.o $(OUT)/libcorsac.a $(OBJ)/link
	$(LINK) $(WRAP_FLAGS) -o $@ $(OBJ)/tools/apidoc/apidoc.o $(OUT)/libcorsac.a $(LIBS)
