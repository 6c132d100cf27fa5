/* Files that are not there, not whole, or damaged. */

#include "abuse.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* xorshift64*: the same damage in every run. */
static uint64_t chance_state = 0x9E3779B97F4A7C15u;

static uint64_t chance(uint64_t below) {
    chance_state ^= chance_state >> 12;
    chance_state ^= chance_state << 25;
    chance_state ^= chance_state >> 27;
    return (chance_state * 0x2545F4914F6CDD1Du >> 16) % below;
}

/* A damaged copy of bytes: cut, with other bits, or with a piece of it elsewhere. `reach` is as far as damage goes. */
static unsigned char *damaged(const unsigned char *bytes, uint64_t length, uint64_t reach, uint64_t *out_length) {
    uint64_t kind = chance(3), n = 1 + chance(8), i;
    uint64_t kept = kind == 0 ? chance(length) : length;
    /* Allocated exactly, so that reading one byte too many is seen. */
    unsigned char *copy = (unsigned char *)room((size_t)kept);
    memcpy(copy, bytes, (size_t)kept);
    for (i = 0; i < n && kind == 1; i++) copy[chance(reach)] ^= (unsigned char)(1u << chance(8));
    if (kind == 2) {
        uint64_t size = 1 + chance(reach / 2), from = chance(length - size), to = chance(reach - size);
        memmove(copy + to, bytes + from, (size_t)size);
    }
    *out_length = kept;
    return copy;
}

void test_no_files(const fixture *f) {
    static const char *const NO_PATHS[] = {"", "/nowhere/at/all.glb", "/", ".", "no_extension", "a.png"};
    anthronet_model *model;
    anthronet_motion *motion;
    anthronet_bytes *bytes;
    double metres[MEASURES];
    size_t i;
    const char *path;
    for (i = 0; i < LENGTH(NO_PATHS); i++) {
        uint64_t length = strlen(NO_PATHS[i]);
        FAILS_OUT(model, anthronet_model_open_path(NO_PATHS[i], length, &model, &fault));
        FAILS_OUT(motion, anthronet_motion_open_path(NO_PATHS[i], length, NULL, &motion, &fault));
        FAILS_OUT(metres, anthronet_measure_file(f->model, NO_PATHS[i], length, metres, MEASURES, NULL, &fault));
        FAILS_OUT(bytes, anthronet_measure_file_report(f->model, NO_PATHS[i], length, &bytes, &fault));
        FAILS(anthronet_export_path(f->body, NULL, NO_PATHS[i], length, &fault));
    }
    REFUSED_OUT(ANTHRONET_ERROR_IO, model, anthronet_model_open_path(TEXT("/nowhere/a"), &model, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_MODEL, model, anthronet_model_open_memory(NULL, 0, &model, &fault));
    path = path_in(f, "empty.bvh");
    write_file(path, "", 0);
    FAILS_OUT(motion, anthronet_motion_open_path(path, strlen(path), NULL, &motion, &fault));
    remove(path);
}

void test_damaged_models(const fixture *f) {
    uint64_t length = 0, size = 0;
    unsigned char *bytes = read_file(f->model_path, &length), *copy;
    anthronet_model *model;
    int i, opened = 0, rounds = f->few ? 3 : 60;
    for (i = 0; i < rounds; i++) {
        /* Every other time in the header, where sizes and offsets are. */
        copy = damaged(bytes, length, i % 2 ? length : 4096, &size);
        model = NULL;
        forget_fault();
        if (anthronet_model_open_memory(copy, size, &model, &fault) == ANTHRONET_OK) {
            anthronet_model_free(model);
            opened++;
        } else {
            CHECK(fault.code == ANTHRONET_ERROR_MODEL, "model %d: %d: %s", i, fault.code, fault.message);
            CHECK(model == NULL, "model %d is written", i);
        }
        free(copy);
    }
    CHECK(opened < rounds / 2, "%d of %d damaged models open", opened, rounds);
    free(bytes);
}

/* Opens damaged copies of a motion file, and brings what opens onto the body. */
static void damage_motion(const fixture *f, const unsigned char *bytes, uint64_t length, const char *name, int rounds) {
    int i, refusals = 0;
    for (i = 0; i < rounds; i++) {
        uint64_t size = 0;
        unsigned char *copy = damaged(bytes, length, i % 2 || length < 2048 ? length : 2048, &size);
        anthronet_motion *motion = NULL;
        int32_t code;
        forget_fault();
        code = anthronet_motion_open_memory(copy, size, name, strlen(name), NULL, &motion, &fault);
        free(copy);
        if (code == ANTHRONET_OK) {
            anthronet_clip *clip = NULL;
            code = anthronet_motion_retarget(motion, 0, f->body, NULL, &clip, NULL, &fault);
            anthronet_clip_free(clip);
            anthronet_motion_free(motion);
        } else {
            CHECK(motion == NULL, "%s %d is written", name, i);
        }
        refusals += code != ANTHRONET_OK;
        CHECK(code == ANTHRONET_OK || (code < ANTHRONET_ERROR_OTHER && code == fault.code), "%s %d: %d: %s", name, i,
              code, fault.message);
    }
    CHECK(refusals > 0 || rounds < 9, "%s: none of %d damaged files is refused", name, rounds);
}

void test_damaged_motions(const fixture *f) {
    static const char *const FORMATS[] = {"glb", "usdc", "usda", "usdz"};
    anthronet_export_options options;
    const anthronet_clip *clips[1];
    anthronet_clip *slow = NULL;
    size_t i;
    damage_motion(f, (const unsigned char *)BVH, strlen(BVH), "a.bvh", f->few ? 8 : 300);
    if (f->few) return;
    /* Few frames and vertices: the damage hits what matters. */
    OK(anthronet_clip_resample(f->walk, 8, &slow, &fault));
    SIZED(options);
    options.lod = 3;
    options.body_only = 1;
    options.clips = clips;
    options.clip_count = 1;
    clips[0] = slow;
    for (i = 0; i < LENGTH(FORMATS); i++) {
        anthronet_bytes *bytes = NULL;
        const uint8_t *data = NULL;
        uint64_t length = 0;
        char name[16] = "a.";
        strcat(name, FORMATS[i]);
        OK(anthronet_export_memory(f->body, &options, FORMATS[i], strlen(FORMATS[i]), &bytes, &fault));
        OK(anthronet_bytes_data(bytes, &data, &length, &fault));
        damage_motion(f, data, length, name, i == 0 ? 120 : 40);
        anthronet_bytes_free(bytes);
    }
    anthronet_clip_free(slow);
}
