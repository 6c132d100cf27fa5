/* Skinning jobs and sources of motions that contradict themselves. */

#include "abuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTER ANTHRONET_ERROR_POINTER
#define SIZE ANTHRONET_ERROR_SIZE

void test_skin_jobs(const fixture *f) {
    anthronet_transform *pose = rest_pose(f, f->body, ANTHRONET_SPACE_GLTF);
    anthronet_skin_job good, bad, two[2];
    uint32_t count = 0, i;
    uint64_t bytes;
    unsigned char *buffer;
    float *offsets;
    OK(anthronet_skinner_vertex_count(f->skinner, &count, &fault));
    bytes = 24 * (uint64_t)count;
    buffer = (unsigned char *)room((size_t)bytes);
    offsets = (float *)room(12 * (size_t)count);
    memset(offsets, 0, 12 * (size_t)count);
    fill(buffer, (size_t)bytes);
    SIZED(good);
    good.skinner = f->skinner;
    good.joints = pose;
    good.joint_count = f->joints;
    good.positions = buffer;
    good.position_bytes = 12 * (uint64_t)count;
#define BAD(code, change) (bad = good, change, REFUSED(code, anthronet_skin(NULL, &bad, 1, &fault)))
#define WRONG(change) (bad = good, (void)(change), FAILS(anthronet_skin(NULL, &bad, 1, &fault)))
    BAD(POINTER, bad.skinner = NULL);
    BAD(POINTER, bad.joints = NULL);
    BAD(POINTER, bad.positions = NULL);
    BAD(POINTER, bad.skinner = CROOKED(anthronet_skinner *, f->skinner));
    BAD(POINTER, bad.joints = CROOKED(anthronet_transform *, pose));
    BAD(POINTER, bad.offset_count = count);
    BAD(ANTHRONET_ERROR_ENUM, bad.method = 3);
    BAD(SIZE, bad.position_bytes = UINT64_MAX);
    WRONG(bad.joint_count = f->joints - 1);
    WRONG(bad.joint_count = 0);
    WRONG(bad.position_bytes = good.position_bytes - 1);
    WRONG(bad.position_bytes = 0);
    WRONG(bad.position_stride = 11);
    WRONG(bad.position_stride = 13);
    WRONG(bad.position_stride = UINT64_MAX);
    WRONG(bad.position_stride = (uint64_t)1 << 63);
    WRONG((bad.offsets = offsets, bad.offset_count = count - 1));
    WRONG((bad.offsets = offsets, bad.offset_count = 1));
    /* Normals: too short, over the positions, of another stride, too far away. */
    WRONG((bad.normals = buffer + good.position_bytes, bad.normal_bytes = good.position_bytes - 1));
    WRONG((bad.normals = buffer + good.position_bytes, bad.normal_bytes = 0));
    WRONG((bad.normals = buffer, bad.normal_bytes = good.position_bytes));
    WRONG((bad.normals = buffer + 4, bad.normal_bytes = good.position_bytes, bad.position_stride = 24, bad.normal_stride = 24,
           bad.position_bytes = bytes));
    WRONG((bad.normals = buffer + 12, bad.normal_bytes = bytes - 12, bad.position_stride = 24, bad.position_bytes = bytes));
    WRONG((bad.normals = buffer + 24, bad.normal_bytes = bytes - 24, bad.position_stride = 24, bad.normal_stride = 24,
           bad.position_bytes = bytes));
    WRONG((bad.normals = buffer + 12, bad.normal_bytes = UINT64_MAX, bad.position_stride = 24, bad.normal_stride = 24,
           bad.position_bytes = bytes));
    /* A pose that is none. */
    for (i = 0; i < 7; i++) {
        float *number = i < 4 ? &pose[9].rotation[i] : &pose[9].translation[i - 4], kept = *number;
        *number = NAN;
        WRONG(0);
        *number = -INFINITY;
        WRONG(0);
        *number = kept;
    }
    offsets[7] = INFINITY;
    WRONG((bad.offsets = offsets, bad.offset_count = count));
    /* The second of two is wrong: the first is not done either. */
    two[0] = two[1] = good;
    two[1].joint_count = 1;
    FAILS(anthronet_skin(NULL, two, 2, &fault));
    two[1] = good;
    two[1].struct_size -= 8;
    FAILS(anthronet_skin(NULL, two, 2, &fault));
    CHECK(is_filled(buffer, (size_t)bytes), "a refused buffer is written to");
    OK(anthronet_skin(NULL, &good, 1, &fault));
    free(buffer);
    free(offsets);
    free(pose);
}

/* Outputs that overlap one another or what the call reads, by a byte or wholly. */
void test_skin_overlaps(const fixture *f) {
    anthronet_transform *pose = rest_pose(f, f->body, ANTHRONET_SPACE_GLTF);
    anthronet_skin_job good[3], jobs[3];
    uint32_t count = 0, i;
    uint64_t packed;
    unsigned char *memory, *behind;
    OK(anthronet_skinner_vertex_count(f->skinner, &count, &fault));
    packed = 12 * (uint64_t)count;
    memory = (unsigned char *)room((size_t)(6 * packed));
    fill(memory, (size_t)(6 * packed));
    behind = memory + 3 * packed;
    for (i = 0; i < 3; i++) {
        SIZED(good[i]);
        good[i].skinner = f->skinner;
        good[i].joints = pose;
        good[i].joint_count = f->joints;
        good[i].positions = memory + i * packed;
        /* More than the vertices need does not count. */
        good[i].position_bytes = 2 * packed;
    }
#define OVERLAPS(change) \
    (memcpy(jobs, good, sizeof jobs), (void)(change), REFUSED(POINTER, anthronet_skin(NULL, jobs, 3, &fault)))
    OVERLAPS(jobs[2].positions = memory);
    OVERLAPS(jobs[0].positions = memory + 2 * packed);
    OVERLAPS(jobs[1].positions = memory + packed - 1);
    OVERLAPS(jobs[1].positions = memory + packed + 1);
    OVERLAPS((jobs[0].positions = behind, jobs[1].positions = behind + 12, jobs[0].position_stride = jobs[1].position_stride = 24,
              jobs[0].position_bytes = jobs[1].position_bytes = 3 * packed - 12));
    OVERLAPS((jobs[2].normals = memory + packed - 12, jobs[2].normal_bytes = packed));
    OVERLAPS((jobs[2].normals = memory + packed + 12, jobs[2].normal_bytes = packed, jobs[2].normal_stride = 12));
    OVERLAPS((jobs[1].offsets = (const float *)(const void *)behind, jobs[1].offset_count = count, jobs[2].positions = behind + 4));
    OVERLAPS((jobs[1].offsets = (const float *)(const void *)(memory + packed), jobs[1].offset_count = count));
    OVERLAPS((memcpy(behind, pose, f->joints * sizeof *pose), jobs[0].joints = (const anthronet_transform *)(const void *)behind,
              jobs[2].positions = behind + 8));
    OVERLAPS(jobs[1].positions = jobs);
    fill(behind, (size_t)packed);
    CHECK(is_filled(memory, (size_t)(6 * packed)), "a refused buffer is written to");
    /* Side by side, and what is read twice, is well. */
    memcpy(jobs, good, sizeof jobs);
    memset(behind, 0, (size_t)packed);
    jobs[0].offsets = jobs[1].offsets = (const float *)(const void *)behind;
    jobs[0].offset_count = jobs[1].offset_count = count;
    OK(anthronet_skin(NULL, jobs, 3, &fault));
    CHECK(memcmp(memory, memory + packed, (size_t)packed) == 0 && memcmp(memory, memory + 2 * packed, (size_t)packed) == 0,
          "three alike differ");
    CHECK(is_filled(memory + 4 * packed, (size_t)(2 * packed)), "something beyond is written");
    free(memory);
    free(pose);
}

static anthronet_text text_of(const char *words) {
    anthronet_text text;
    text.data = words;
    text.length = strlen(words);
    return text;
}

void test_sources(const fixture *f) {
    anthronet_transform rest[3], frames[6];
    anthronet_text names[3];
    int32_t parents[3] = {-1, 0, 1};
    anthronet_motion_source good, bad;
    anthronet_motion *motion = NULL;
    int i;
    (void)f;
    ZERO(rest);
    for (i = 0; i < 3; i++) rest[i].rotation[3] = 1, rest[i].translation[1] = 0.3f;
    for (i = 0; i < 6; i++) frames[i] = rest[i % 3];
    names[0] = text_of("hips");
    names[1] = text_of("spine");
    names[2] = text_of("head");
    SIZED(good);
    good.joint_count = 3;
    good.frame_count = 2;
    good.frames_per_second = 30;
    good.name = text_of("mine");
    good.joint_names = names;
    good.parents = parents;
    good.rest = rest;
    good.frames = frames;
    OK(anthronet_motion_from_poses(&good, &motion, &fault));
    anthronet_motion_free(motion);
#undef WRONG
#define WRONG(change) (bad = good, (void)(change), FAILS_OUT(motion, anthronet_motion_from_poses(&bad, &motion, &fault)))
    WRONG(bad.joint_names = NULL);
    WRONG(bad.parents = NULL);
    WRONG(bad.rest = NULL);
    WRONG(bad.frames = NULL);
    WRONG(bad.joint_count = 0);
    WRONG(bad.frame_count = 0);
    WRONG(bad.frames_per_second = 0);
    WRONG(bad.frames_per_second = NAN);
    WRONG(bad.frames_per_second = -30);
    WRONG(bad.name.data = NULL);
    WRONG(bad.name.length = UINT64_MAX);
    names[1].data = NULL;
    WRONG(0);
    names[1] = text_of("hips");
    WRONG(0);
    names[1] = text_of("\xFF");
    WRONG(0);
    names[1] = text_of("spine");
    for (i = -3; i < 4; i++) {
        /* A joint's own parent, or behind it, or nowhere. */
        parents[1] = i;
        if (i != -1 && i != 0) WRONG(0);
    }
    parents[1] = INT32_MIN;
    WRONG(0);
    parents[1] = INT32_MAX;
    WRONG(0);
    parents[1] = 0;
    frames[4].rotation[2] = NAN;
    WRONG(0);
    frames[4].rotation[2] = 0;
    frames[4].translation[0] = INFINITY;
    WRONG(0);
    frames[4].translation[0] = 0;
    rest[2].translation[0] = NAN;
    WRONG(0);
    rest[2].translation[0] = 0;
    memset(rest[2].rotation, 0, sizeof rest[2].rotation);
    WRONG(0);
}
