// A world in a saved scene: sources, groups, listener. Sounds are the scene's own.
#include "audio/audio_internal.h"
#include "core/hash.h"

static uint64_t sounds_hash(const audio_world *w) {
    uint64_t column[CORE_COLUMNS_MAX], hash = core_pool_hash(&w->sound.set.pool);
    core_columns_hash(&w->sound.set, column);
    for (uint32_t c = 0; c < w->sound.set.column_count; c++) {
        hash = core_hash_mix(hash, column[c]);
    }
    return hash;
}

static bool check(audio_world *w, core_stream *s) {
    for (uint32_t i = 0; i < core_columns_count(&w->source.set); i++) {
        uint32_t sound = core_columns_row(&w->sound.set, w->source.sound[i]);
        if (sound == CORE_NO_ROW || w->source.group[i] >= w->groups ||
            !(w->source.frame[i] >= 0 && w->source.frame[i] <= w->sound.frames[sound])) {
            return core_stream_fail(s, "audio.sources", "row %u plays what the scene has not", i);
        }
        w->source.clear[i] = 1;
    }
    w->voice_count = 0;
    return true;
}

bool audio_world_stream(audio_world *w, core_stream *s) {
    bool good = core_stream_open(s, "audio") &&
                core_stream_same(s, "sounds", sounds_hash(w), "the scene has other sounds") &&
                core_stream_count(s, "groups", &w->groups, AUDIO_MAX_GROUPS);
    for (uint32_t i = 0; good && i < w->groups; i++) {
        good = core_stream_string(s, "group", w->group[i].name, AUDIO_GROUP_NAME) &&
               core_stream_list(s, "gain", 'f', &w->group[i].gain, sizeof(float));
    }
    good = good && core_stream_list(s, "listener", 'f', &w->listener, sizeof w->listener) &&
           core_stream_columns(s, &w->source.set) && core_stream_close(s) &&
           (s->writing || check(w, s));
    if (!good && !s->writing) {
        core_columns_clear(&w->source.set);
    }
    return good;
}
