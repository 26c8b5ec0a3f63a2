// Ogg Vorbis to 16-bit samples. Two walls stand between a file and the engine: pages are checked
// here (RFC 3533: sizes, order, checksums), and what passes is decoded in a process of its own, as
// the decoder (stb_vorbis of the system) is known to fail on streams that were made to hurt it. It
// gets a fixed block to work in, no files, a limit of processor time, and hands back samples only.
#include "asset/ogg_file.h"

#include "asset/asset.h"
#include "asset/bytes.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#define STB_VORBIS_HEADER_ONLY
#include <stb_vorbis.h>

#define PAGE_HEAD     27u
#define WORK_BYTES    (8 << 20) // of the decoder: codebooks and one window
#define MOST_SAMPLES  (1u << 28)
#define CPU_SECONDS   30
#define FLAG_LAST     4u
#define UNKNOWN_PLACE UINT64_MAX

typedef struct decoded { // shared with the child
    uint32_t channels, rate, frames;
    int16_t sample[];
} decoded;

static uint32_t u32_at(const uint8_t *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

// RFC 3533, 6: polynomial 0x04c11db7, most significant bit first, over the page with a zero here.
static uint32_t page_checksum(const uint8_t *page, size_t size) {
    uint32_t crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= (uint32_t)(i - 22 < 4 ? 0 : page[i]) << 24;
        for (int bit = 0; bit < 8; bit++) {
            crc = crc << 1 ^ (crc >> 31 ? 0x04c11db7u : 0);
        }
    }
    return crc;
}

// Size of the page at the front, 0 + core_fail when it is none.
static size_t check_page(const uint8_t *p, size_t left, uint32_t number, const char *path) {
    size_t head = left < PAGE_HEAD ? 0 : PAGE_HEAD + p[26], size = head;
    if (head == 0 || left < head || memcmp(p, "OggS", 4) != 0 || p[4] != 0) {
        core_fail("%s: OGG: page %u: no page, or cut off", path, number);
        return 0;
    }
    for (size_t i = PAGE_HEAD; i < head; i++) {
        size += p[i];
    }
    if (size > left) {
        core_fail("%s: OGG: page %u: %zu bytes, %zu are left", path, number, size, left);
        return 0;
    }
    if (page_checksum(p, size) != u32_at(p + 22)) {
        core_fail("%s: OGG: page %u: the checksum is another; the file is damaged", path, number);
        return 0;
    }
    return size;
}

// Pages of one stream in their order, from the first to the last. *frames: where the last one ends.
static bool check_pages(const uint8_t *p, size_t size, uint64_t *frames, const char *path) {
    uint32_t serial = size >= PAGE_HEAD ? u32_at(p + 14) : 0, number = 0;
    bool last = false;
    *frames = 0;
    for (size_t at = 0; at < size; number++) {
        size_t page = check_page(p + at, size - at, number, path);
        if (page == 0) {
            return false;
        }
        if (u32_at(p + at + 14) != serial || u32_at(p + at + 18) != number || last) {
            return core_fail("%s: OGG: page %u: of another stream, or not the next", path, number);
        }
        uint64_t place = (uint64_t)u32_at(p + at + 10) << 32 | u32_at(p + at + 6);
        *frames = place == UNKNOWN_PLACE ? *frames : place;
        last = p[at + 5] & FLAG_LAST;
        at += page;
    }
    return (last && number >= 2) || core_fail("%s: OGG: the end of the stream is missing", path);
}

// In the child: no library of the parent is touched but the decoder, and nothing is allocated.
static void decode_and_exit(const uint8_t *bytes, int size, char *work, decoded *out,
                            uint32_t most) {
    static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    for (size_t i = 0; i < CORE_COUNT_OF(fatal); i++) {
        signal(fatal[i], SIG_DFL);
    }
    struct rlimit cpu = {CPU_SECONDS, CPU_SECONDS}, none = {0, 0};
    setrlimit(RLIMIT_CPU, &cpu);
    setrlimit(RLIMIT_CORE, &none);
    stb_vorbis_alloc memory = {work, WORK_BYTES};
    int error = 0;
    stb_vorbis *v = stb_vorbis_open_memory(bytes, size, &error, &memory);
    if (!v) {
        _exit(1);
    }
    stb_vorbis_info info = stb_vorbis_get_info(v);
    if (info.channels < 1 || info.channels > 2 || info.sample_rate < 1000 ||
        info.sample_rate > 192000) {
        _exit(2);
    }
    uint32_t channels = (uint32_t)info.channels, done = 0;
    for (;;) {
        uint32_t left = most - done * channels, want = CORE_MIN(left, 1u << 16);
        int n = stb_vorbis_get_samples_short_interleaved(
            v, info.channels, out->sample + (size_t)done * channels, (int)want);
        if (n <= 0) {
            break;
        }
        done += (uint32_t)n;
    }
    out->channels = channels;
    out->rate = info.sample_rate;
    out->frames = done;
    _exit(0);
}

static int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) {
            return -1;
        }
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static core_sound_data *keep(const decoded *d, uint32_t most, const char *path) {
    if (d->frames == 0 || d->channels < 1 || d->channels > 2 || d->frames > most / d->channels) {
        core_fail("%s: OGG: no samples", path);
        return NULL;
    }
    size_t bytes = (size_t)d->frames * d->channels * sizeof(int16_t);
    asset_block block = asset_block_make(asset_round(sizeof(core_sound_data)) + asset_round(bytes));
    core_sound_data *s = asset_block_take(&block, sizeof *s);
    int16_t *sample = asset_block_take(&block, bytes);
    memcpy(sample, d->sample, bytes);
    *s = (core_sound_data){d->channels, d->rate, d->frames, sample};
    return s;
}

core_sound_data *asset_ogg_decode(const void *bytes, size_t size, const char *path) {
    uint64_t frames;
    if (size > INT32_MAX || !check_pages(bytes, size, &frames, path)) {
        return NULL;
    }
    if (frames == 0 || frames > MOST_SAMPLES / 2) {
        core_fail("%s: OGG: %llu frames, expected 1 to %u", path, (unsigned long long)frames,
                  MOST_SAMPLES / 2);
        return NULL;
    }
    uint32_t most = (uint32_t)frames * 2;
    size_t shared = asset_round(sizeof(decoded) + most * sizeof(int16_t));
    decoded *out = mmap(NULL, shared + WORK_BYTES, PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (out == MAP_FAILED) {
        core_fail("%s: OGG: no memory for %u samples", path, most);
        return NULL;
    }
    core_sound_data *sound = NULL;
    pid_t child = fork();
    if (child == 0) {
        decode_and_exit(bytes, (int)size, (char *)out + shared, out, most);
    }
    int code = child < 0 ? -2 : wait_for(child);
    if (code == 0) {
        sound = keep(out, most, path);
    } else {
        core_fail("%s: OGG: %s", path,
                  code == 2    ? "expected Vorbis with 1 or 2 channels at 1000..192000 Hz"
                  : code == -2 ? "no process to decode it in"
                               : "no Vorbis that can be decoded");
    }
    munmap(out, shared + WORK_BYTES);
    return sound;
}
