/* Sizes, enumerations, numbers, counts, strides and texts that are not what they must be. */

#include "abuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIZE ANTHRONET_ERROR_SIZE
#define ENUM ANTHRONET_ERROR_ENUM
#define INDEX ANTHRONET_ERROR_INDEX
#define REQUEST ANTHRONET_ERROR_REQUEST

static const uint32_t NO_SIZES[] = {0, 1, 2, 3, 4097, 1000000, UINT32_MAX};
static const uint32_t NO_ENUMS[] = {100, 0x7FFFFFFF, 0x80000000, UINT32_MAX};
static const double NOT_FINITE[] = {NAN, INFINITY, -INFINITY};

void test_struct_sizes(const fixture *f) {
    anthronet_body_summary summary, whole;
    anthronet_mesh_options options;
    anthronet_motion_options read;
    anthronet_retarget_options retarget;
    anthronet_export_options export_options;
    anthronet_humanoid_bone bone;
    anthronet_measured measured;
    anthronet_clip_info info;
    anthronet_mesh_part part;
    anthronet_motion_source source;
    anthronet_skin_job job;
    anthronet_job_progress progress;
    anthronet_job *running = NULL;
    anthronet_mesh *mesh;
    anthronet_motion *motion;
    anthronet_clip *clip;
    anthronet_bytes *bytes;
    double metres[MEASURES];
    union {
        anthronet_body_summary known;
        unsigned char bytes[4096];
    } large;
    size_t i;
    OK(anthronet_job_start(f->model, NULL, 0, &running, &fault));
    for (i = 0; i < LENGTH(NO_SIZES); i++) {
        uint32_t size = NO_SIZES[i];
        fill(&summary, sizeof summary);
        summary.struct_size = size;
        REFUSED(SIZE, anthronet_body_summarise(f->body, &summary, &fault));
        CHECK(is_filled((char *)&summary + 4, sizeof summary - 4), "a summary of %u bytes is written", size);
        ZERO(options);
        options.struct_size = size;
        REFUSED_OUT(SIZE, mesh, anthronet_mesh_new(f->body, &options, &mesh, &fault));
        ZERO(read);
        read.struct_size = size;
        REFUSED_OUT(SIZE, motion, anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), TEXT("a.bvh"), &read, &motion, &fault));
        ZERO(retarget);
        retarget.struct_size = size;
        REFUSED_OUT(SIZE, clip, anthronet_motion_retarget(f->motion, 0, f->body, &retarget, &clip, NULL, &fault));
        ZERO(export_options);
        export_options.struct_size = size;
        REFUSED_OUT(SIZE, bytes, anthronet_export_memory(f->body, &export_options, TEXT("glb"), &bytes, &fault));
        REFUSED(SIZE, anthronet_export_path(f->body, &export_options, TEXT("a.glb"), &fault));
        bone.struct_size = size;
        REFUSED(SIZE, anthronet_humanoid_bone_at(0, &bone, &fault));
        measured.struct_size = size;
        REFUSED_OUT(SIZE, metres, anthronet_measure_mesh(f->model, metres, 1, 0, 0, metres, MEASURES, &measured, &fault));
        REFUSED_OUT(SIZE, metres, anthronet_measure_file(f->model, TEXT("a.glb"), metres, MEASURES, &measured, &fault));
        info.struct_size = size;
        REFUSED(SIZE, anthronet_clip_describe(f->walk, &info, &fault));
        part.struct_size = size;
        REFUSED(SIZE, anthronet_mesh_describe_part(f->mesh, 0, &part, &fault));
        ZERO(source);
        source.struct_size = size;
        REFUSED_OUT(SIZE, motion, anthronet_motion_from_poses(&source, &motion, &fault));
        ZERO(job);
        job.struct_size = size;
        REFUSED(SIZE, anthronet_skin(NULL, &job, 1, &fault));
        progress.struct_size = size;
        REFUSED(SIZE, anthronet_job_poll(running, &progress, &fault));
    }
    anthronet_job_free(running);
    /* An older caller's structure is filled as far as it goes, a younger one's as far as we know. */
    SIZED(whole);
    OK(anthronet_body_summarise(f->body, &whole, &fault));
    fill(&summary, sizeof summary);
    summary.struct_size = 16;
    OK(anthronet_body_summarise(f->body, &summary, &fault));
    CHECK(summary.sex == whole.sex && summary.seed == whole.seed && summary.struct_size == 16, "the first 16 bytes");
    CHECK(is_filled((char *)&summary + 16, sizeof summary - 16), "more than 16 bytes are written");
    fill(&large, sizeof large);
    large.known.struct_size = sizeof large;
    OK(anthronet_body_summarise(f->body, &large.known, &fault));
    CHECK(large.known.joint_count == f->joints && is_filled(large.bytes + sizeof whole, sizeof large - sizeof whole),
          "a structure of 4096 bytes");
    /* Only the size: all defaults. */
    options.struct_size = 4;
    options.lod = 99;
    OK(anthronet_mesh_new(f->body, &options, &mesh, &fault));
    anthronet_mesh_free(mesh);
}

void test_enumerations(const fixture *f) {
    anthronet_request *request = NULL;
    anthronet_mesh *mesh;
    anthronet_clip *clip;
    anthronet_motion *motion;
    anthronet_bytes *bytes;
    anthronet_view view;
    anthronet_text text;
    anthronet_joint *joints = (anthronet_joint *)room(f->joints * sizeof *joints);
    anthronet_transform *pose = (anthronet_transform *)room(f->joints * sizeof *pose);
    uint32_t number;
    double metres[MEASURES];
    size_t i, k;
    OK(anthronet_request_new(&request, &fault));
    for (i = 0; i < LENGTH(NO_ENUMS); i++) {
        uint32_t wrong = NO_ENUMS[i];
        REFUSED(ENUM, anthronet_request_set_sex(request, wrong, &fault));
        REFUSED(ENUM, anthronet_request_set_fill(request, wrong, &fault));
        REFUSED(ENUM, anthronet_request_set_nearest(request, wrong, &fault));
        REFUSED_OUT(ENUM, number, anthronet_model_vertex_count(f->model, wrong, &number, &fault));
        REFUSED_OUT(ENUM, metres, anthronet_measure_mesh(f->model, metres, 1, 0, wrong, metres, MEASURES, NULL, &fault));
        REFUSED(ENUM, anthronet_body_joints(f->body, wrong, joints, f->joints, &fault));
        REFUSED_OUT(ENUM, text, anthronet_body_joint_name(f->body, 0, wrong, &text, &fault));
        REFUSED_OUT(ENUM, view, anthronet_mesh_data(f->mesh, 0, wrong, &view, &fault));
        REFUSED(ENUM, anthronet_mesh_read(f->mesh, 0, wrong, pose, 28, 0, &fault));
        REFUSED(ENUM, anthronet_clip_sample(f->walk, NULL, 0, wrong, 0, 0, pose, f->joints, &fault));
        REFUSED(ENUM, anthronet_clip_sample(f->walk, NULL, 0, 0, wrong, 0, pose, f->joints, &fault));
        REFUSED(ENUM, anthronet_clip_sample(f->walk, NULL, 0, 0, 0, wrong, pose, f->joints, &fault));
        REFUSED(ENUM, anthronet_clip_bake(f->walk, wrong, 0, pose, 1, &fault));
        REFUSED(ENUM, anthronet_clip_bake(f->walk, 0, wrong, pose, 1, &fault));
        REFUSED_OUT(ENUM, clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, wrong, pose, f->joints, &clip, &fault));
        REFUSED_OUT(ENUM, clip, anthronet_clip_additive(f->walk, f->walk, 1, NULL, 0, wrong, NULL, 0, &clip, &fault));
        for (k = 1; k < 7; k++) {
            anthronet_mesh_options options;
            SIZED(options);
            memcpy((char *)&options + 4 * k, &wrong, 4);
            /* The third is a number, not an enumeration. */
            REFUSED_OUT(k == 2 ? REQUEST : ENUM, mesh, anthronet_mesh_new(f->body, &options, &mesh, &fault));
        }
        for (k = 1; k < 7; k++) {
            anthronet_export_options options;
            SIZED(options);
            memcpy((char *)&options + 4 * k, &wrong, 4);
            REFUSED_OUT(k == 2 ? REQUEST : ENUM, bytes,
                        anthronet_export_memory(f->body, &options, TEXT("glb"), &bytes, &fault));
        }
        for (k = 1; k < 7; k++) {
            anthronet_retarget_options options;
            SIZED(options);
            memcpy((char *)&options + 4 * k, &wrong, 4);
            REFUSED_OUT(ENUM, clip, anthronet_motion_retarget(f->motion, 0, f->body, &options, &clip, NULL, &fault));
        }
        {
            anthronet_motion_options options;
            anthronet_motion_source source;
            SIZED(options);
            options.person = wrong;
            REFUSED_OUT(REQUEST, motion, anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), TEXT("a.bvh"), &options, &motion, &fault));
            SIZED(options);
            options.up = wrong;
            REFUSED_OUT(ENUM, motion, anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), TEXT("a.bvh"), &options, &motion, &fault));
            SIZED(source);
            source.space = wrong;
            REFUSED_OUT(ENUM, motion, anthronet_motion_from_poses(&source, &motion, &fault));
        }
        REFUSED_OUT(INDEX, text, anthronet_measure_name(wrong, &text, &fault));
        REFUSED(INDEX, anthronet_request_unset_measure(request, wrong, &fault));
        REFUSED_OUT(INDEX, metres[0], anthronet_model_measure_range(f->model, wrong, &metres[0], &metres[1], &fault));
        REFUSED_OUT(INDEX, text, anthronet_body_joint_name(f->body, wrong, 0, &text, &fault));
        REFUSED_OUT(INDEX, text, anthronet_clip_builtin_name(wrong, &text, &fault));
        REFUSED_OUT(INDEX, text, anthronet_motion_clip_name(f->motion, wrong, &text, &fault));
        REFUSED_OUT(INDEX, clip, anthronet_motion_retarget(f->motion, wrong, f->body, NULL, &clip, NULL, &fault));
        REFUSED_OUT(INDEX, view, anthronet_mesh_data(f->mesh, wrong, 0, &view, &fault));
        REFUSED(INDEX, anthronet_mesh_read(f->mesh, wrong, 0, pose, 28, 0, &fault));
        {
            anthronet_mesh_part part;
            anthronet_humanoid_bone bone;
            anthronet_skinner *skinner;
            SIZED(part);
            SIZED(bone);
            REFUSED(INDEX, anthronet_mesh_describe_part(f->mesh, wrong, &part, &fault));
            REFUSED(INDEX, anthronet_humanoid_bone_at(wrong, &bone, &fault));
            REFUSED_OUT(INDEX, skinner, anthronet_skinner_new(f->mesh, wrong, &skinner, &fault));
        }
    }
    anthronet_request_free(request);
    free(joints);
    free(pose);
}

void test_numbers(const fixture *f) {
    static const double NO_LENGTHS[] = {NAN, INFINITY, -INFINITY, -1, 0, 1e-300, 1e300, 1700};
    static const double NO_RATES[] = {NAN, INFINITY, -INFINITY, -30, 0, 1e-300, 1e300, 1e9};
    anthronet_request *request = NULL;
    anthronet_body *body;
    anthronet_clip *clip;
    anthronet_motion *motion;
    anthronet_motion_options read;
    anthronet_retarget_options retarget;
    anthronet_transform *pose = rest_pose(f, f->body, ANTHRONET_SPACE_GLTF);
    double metres[MEASURES], seen[MEASURES], latent[4] = {0, 0, 0, NAN};
    uint8_t given[MEASURES], seen_given[MEASURES];
    float *positions, *mask = (float *)room(f->joints * sizeof *mask);
    uint32_t vertices = 0;
    size_t i;
    OK(anthronet_request_new(&request, &fault));
    for (i = 0; i < f->joints; i++) mask[i] = 1;
    for (i = 0; i < LENGTH(NOT_FINITE); i++) {
        double bad = NOT_FINITE[i];
        REFUSED(REQUEST, anthronet_request_set_measure(request, TEXT("height"), bad, &fault));
        ZERO(metres);
        ZERO(given);
        metres[7] = bad;
        given[7] = 1;
        REFUSED(REQUEST, anthronet_request_set_measures(request, metres, given, MEASURES, &fault));
        FAILS_OUT(body, anthronet_interpolate(f->model, f->request, f->request, bad, &body, &fault));
        REFUSED(REQUEST, anthronet_clip_sample(f->walk, NULL, bad, 0, 0, 0, pose, f->joints, &fault));
        FAILS_OUT(clip, anthronet_clip_looped(f->walk, bad, &clip, &fault));
        FAILS_OUT(clip, anthronet_clip_crossfade(f->walk, f->walk, bad, &clip, &fault));
        FAILS_OUT(clip, anthronet_clip_blend(f->walk, f->walk, (float)bad, &clip, &fault));
        FAILS_OUT(clip, anthronet_clip_blend_masked(f->walk, f->walk, (float)bad, mask, f->joints, &clip, &fault));
        FAILS_OUT(clip, anthronet_clip_additive(f->walk, f->walk, (float)bad, NULL, 0, 0, NULL, 0, &clip, &fault));
        mask[9] = (float)bad;
        FAILS_OUT(clip, anthronet_clip_blend_masked(f->walk, f->walk, 1, mask, f->joints, &clip, &fault));
        FAILS_OUT(clip, anthronet_clip_additive(f->walk, f->walk, 1, NULL, 0, 0, mask, f->joints, &clip, &fault));
        mask[9] = 1;
        pose[9].translation[1] = (float)bad;
        FAILS_OUT(clip, anthronet_clip_additive(f->walk, f->walk, 1, pose, f->joints, 0, NULL, 0, &clip, &fault));
        pose[9].translation[1] = 0;
    }
    REFUSED(REQUEST, anthronet_request_set_latent(request, latent, 4, &fault));
    given[7] = 2;
    metres[7] = 1;
    REFUSED(ENUM, anthronet_request_set_measures(request, metres, given, MEASURES, &fault));
    OK(anthronet_request_measures(request, seen, seen_given, MEASURES, &fault));
    for (i = 0; i < MEASURES; i++) CHECK(!seen_given[i] && seen[i] == 0, "a refused measure stays");
    FAILS_OUT(body, anthronet_interpolate(f->model, f->request, f->request, -0.1, &body, &fault));
    FAILS_OUT(body, anthronet_interpolate(f->model, f->request, f->request, 1.1, &body, &fault));
    for (i = 3; i < LENGTH(NO_LENGTHS); i++) {
        anthronet_request *other = NULL;
        OK(anthronet_request_new(&other, &fault));
        if (anthronet_request_set_measure(other, TEXT("height"), NO_LENGTHS[i], &fault) == ANTHRONET_OK) {
            FAILS_OUT(body, anthronet_generate(f->model, other, &body, &fault));
        }
        anthronet_request_free(other);
    }
    OK(anthronet_request_set_latent(request, latent, 3, &fault));
    FAILS_OUT(body, anthronet_generate(f->model, request, &body, &fault));
    for (i = 0; i < LENGTH(NO_RATES); i++) {
        SIZED(read);
        SIZED(retarget);
        read.frames_per_second = retarget.frames_per_second = NO_RATES[i];
        FAILS_OUT(clip, anthronet_clip_resample(f->walk, NO_RATES[i], &clip, &fault));
        /* 1e9 frames per second are possible for so few frames. */
        if (NO_RATES[i] != 1e9) FAILS_OUT(clip, anthronet_clip_from_poses(f->body, TEXT("a"), NO_RATES[i], 0, pose, f->joints, &clip, &fault));
        if (NO_RATES[i] == 0) continue;
        FAILS_OUT(clip, anthronet_motion_retarget(f->motion, 0, f->body, &retarget, &clip, NULL, &fault));
        if (NO_RATES[i] != 1e9) {
            FAILS_OUT(motion, anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), TEXT("a.bvh"), &read, &motion, &fault));
        }
        SIZED(read);
        read.metres_per_unit = NO_RATES[i];
        if (i < 4) FAILS_OUT(motion, anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), TEXT("a.bvh"), &read, &motion, &fault));
    }
    FAILS_OUT(clip, anthronet_clip_looped(f->walk, -1, &clip, &fault));
    FAILS_OUT(clip, anthronet_clip_looped(f->walk, 1e6, &clip, &fault));
    FAILS_OUT(clip, anthronet_clip_crossfade(f->walk, f->walk, -1, &clip, &fault));
    FAILS_OUT(clip, anthronet_clip_crossfade(f->walk, f->walk, 1e6, &clip, &fault));
    REFUSED(REQUEST, anthronet_clip_sample(f->walk, NULL, 1e300, 2, 0, 0, pose, f->joints, &fault));
    OK(anthronet_clip_sample(f->walk, NULL, -1e9, 1, 0, 0, pose, f->joints, &fault));
    OK(anthronet_clip_sample(f->walk, NULL, 1e9, 2, 0, 0, pose, f->joints, &fault));
    for (i = 0; i < f->joints; i++) CHECK(isfinite(pose[i].rotation[3]) && isfinite(pose[i].translation[2]), "joint %u", (unsigned)i);
    /* A mesh that is not one. */
    OK(anthronet_model_vertex_count(f->model, 1, &vertices, &fault));
    positions = (float *)room(12 * (size_t)vertices);
    memset(positions, 0xFF, 12 * (size_t)vertices);
    FAILS_OUT(metres, anthronet_measure_mesh(f->model, positions, vertices, 0, 0, metres, MEASURES, NULL, &fault));
    memset(positions, 0, 12 * (size_t)vertices);
    if (anthronet_measure_mesh(f->model, positions, vertices, 0, 0, metres, MEASURES, NULL, &fault) == ANTHRONET_OK) {
        for (i = 0; i < MEASURES; i++) CHECK(isfinite(metres[i]), "measure %u of a point", (unsigned)i);
    }
    FAILS_OUT(metres, anthronet_measure_mesh(f->model, positions, vertices - 1, 0, 0, metres, MEASURES, NULL, &fault));
    FAILS_OUT(metres, anthronet_measure_mesh(f->model, NULL, 0, 0, 0, metres, MEASURES, NULL, &fault));
    free(positions);
    free(mask);
    free(pose);
    anthronet_request_free(request);
}

void test_counts(const fixture *f) {
    static const uint32_t NO_COUNTS[] = {0, 1, MEASURES - 1, MEASURES + 1, UINT32_MAX};
    anthronet_measure_report report[MEASURES];
    anthronet_joint joint;
    anthronet_transform pose;
    anthronet_motion *motion;
    anthronet_model *model;
    anthronet_clip *clip;
    anthronet_job *job;
    anthronet_request *request;
    anthronet_motion_source source;
    double metres[MEASURES], latent;
    uint8_t given[MEASURES];
    uint32_t number;
    size_t i;
    ZERO(pose);
    for (i = 0; i < LENGTH(NO_COUNTS); i++) {
        uint32_t count = NO_COUNTS[i];
        REFUSED_OUT(SIZE, report, anthronet_body_measures(f->body, report, count, &fault));
        REFUSED(SIZE, anthronet_request_set_measures(f->request, metres, given, count, &fault));
        REFUSED_OUT(SIZE, metres, anthronet_request_measures(f->request, metres, given, count, &fault));
        REFUSED_OUT(SIZE, metres, anthronet_measure_mesh(f->model, metres, 1, 0, 0, metres, count, NULL, &fault));
        REFUSED_OUT(SIZE, metres, anthronet_measure_file(f->model, TEXT("a.glb"), metres, count, NULL, &fault));
        REFUSED_OUT(SIZE, joint, anthronet_body_joints(f->body, 0, &joint, count, &fault));
        REFUSED_OUT(SIZE, latent, anthronet_body_latent(f->body, &latent, count, &fault));
        REFUSED_OUT(SIZE, pose, anthronet_clip_sample(f->walk, NULL, 0, 0, 0, 0, &pose, count, &fault));
        REFUSED_OUT(SIZE, pose, anthronet_clip_bake(f->walk, 0, 0, &pose, count, &fault));
    }
    REFUSED_OUT(SIZE, pose, anthronet_clip_bake(f->walk, 0, 0, &pose, UINT64_MAX, &fault));
    REFUSED_OUT(SIZE, joint, anthronet_body_joints(f->body, 0, &joint, f->joints - 1, &fault));
    REFUSED_OUT(SIZE, joint, anthronet_body_joints(f->body, 0, &joint, f->joints + 1, &fault));
    /* More than any memory holds. */
    REFUSED_OUT(SIZE, model, anthronet_model_open_memory((const uint8_t *)"a", UINT64_MAX, &model, &fault));
    REFUSED_OUT(SIZE, model, anthronet_model_open_path("a", UINT64_MAX, &model, &fault));
    REFUSED_OUT(SIZE, motion, anthronet_motion_open_memory((const uint8_t *)"a", UINT64_MAX, TEXT("a.bvh"), NULL, &motion, &fault));
    REFUSED_OUT(SIZE, motion, anthronet_motion_open_memory((const uint8_t *)"a", 1, "a", UINT64_MAX, NULL, &motion, &fault));
    REFUSED_OUT(SIZE, clip, anthronet_clip_builtin("walk", UINT64_MAX / 2 + 1, f->body, &clip, &fault));
    REFUSED_OUT(SIZE, clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, &pose, UINT64_MAX / 16, &clip, &fault));
    FAILS_OUT(clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, &pose, 1, &clip, &fault));
    FAILS_OUT(clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, &pose, 0, &clip, &fault));
    REFUSED_OUT(SIZE, request, anthronet_request_from_json("{}", UINT64_MAX, &request, &fault));
    REFUSED_OUT(SIZE, number, anthronet_measure_index("height", UINT64_MAX, &number, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_POINTER, job, anthronet_job_start(f->model, NULL, 1, &job, &fault));
    REFUSED(ANTHRONET_ERROR_POINTER, anthronet_skin(NULL, NULL, UINT32_MAX, &fault));
    SIZED(source);
    source.joint_count = source.frame_count = UINT32_MAX;
    source.frames_per_second = 30;
    FAILS_OUT(motion, anthronet_motion_from_poses(&source, &motion, &fault));
}

/* Counts that say more than the small buffers beside them hold, by one or by far: refused before anything is read. */
void test_counts_too_large(const fixture *f) {
    static const uint32_t BY[] = {1, UINT32_MAX / 2, UINT32_MAX};
    anthronet_transform *pose = rest_pose(f, f->body, ANTHRONET_SPACE_GLTF), *exact;
    uint32_t count = 0, vertices = 0;
    anthronet_skin_job job;
    anthronet_motion_source source, wrong;
    anthronet_export_options export_options;
    anthronet_retarget_options retarget;
    anthronet_text name;
    const anthronet_clip *clips[1];
    const anthronet_request *requests[1];
    anthronet_bytes *bytes;
    anthronet_clip *clip;
    anthronet_job *running;
    anthronet_model *model;
    anthronet_motion *motion;
    anthronet_request *request, *mine = NULL;
    int32_t parent = -1;
    uint64_t joints = f->joints;
    double latent[1] = {0}, metres[MEASURES];
    float *floats, mask = 1;
    size_t i;
    OK(anthronet_skinner_vertex_count(f->skinner, &count, &fault));
    OK(anthronet_model_vertex_count(f->model, 3, &vertices, &fault));
    OK(anthronet_request_new(&mine, &fault));
    /* Allocated exactly, so that reading one number too many is seen. */
    floats = (float *)room(24 * (size_t)count);
    memset(floats, 0, 24 * (size_t)count);
    exact = (anthronet_transform *)room(f->joints * sizeof *exact);
    memcpy(exact, pose, f->joints * sizeof *exact);
    clips[0] = f->walk;
    requests[0] = f->request;
    name.data = "hips";
    name.length = 4;
    SIZED(source);
    source.joint_count = source.frame_count = 1;
    source.frames_per_second = 30;
    source.name = name;
    source.joint_names = &name;
    source.parents = &parent;
    source.rest = source.frames = exact;
    OK(anthronet_motion_from_poses(&source, &motion, &fault));
    anthronet_motion_free(motion);
    for (i = 0; i < LENGTH(BY); i++) {
        uint32_t by = BY[i];
#define LARGER(n) ((n) > UINT32_MAX - by ? UINT32_MAX : (uint32_t)((n) + by))
        SIZED(job);
        job.skinner = f->skinner;
        job.joints = exact;
        job.joint_count = LARGER(f->joints);
        job.positions = floats;
        job.position_bytes = 12 * (uint64_t)count;
        REFUSED(SIZE, anthronet_skin(NULL, &job, 1, &fault));
        job.joint_count = f->joints;
        job.offsets = floats + 3 * (size_t)count;
        job.offset_count = LARGER(count);
        REFUSED(SIZE, anthronet_skin(NULL, &job, 1, &fault));
        if (LARGER(1 << 20) > 1 << 20) REFUSED(SIZE, anthronet_skin(NULL, &job, LARGER(1 << 20), &fault));
        REFUSED_OUT(SIZE, metres, anthronet_measure_mesh(f->model, floats, LARGER(vertices), 0, 0, metres, MEASURES, NULL, &fault));
        REFUSED(SIZE, anthronet_request_set_latent(mine, latent, LARGER(256), &fault));
        wrong = source;
        wrong.joint_count = LARGER(4096);
        REFUSED_OUT(SIZE, motion, anthronet_motion_from_poses(&wrong, &motion, &fault));
        wrong = source;
        wrong.frame_count = LARGER(1 << 20);
        REFUSED_OUT(SIZE, motion, anthronet_motion_from_poses(&wrong, &motion, &fault));
        wrong.joint_count = 4096;
        wrong.frame_count = LARGER(1 << 16);
        REFUSED_OUT(SIZE, motion, anthronet_motion_from_poses(&wrong, &motion, &fault));
        REFUSED_OUT(SIZE, clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, exact, joints + by, &clip, &fault));
        REFUSED_OUT(SIZE, clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, exact, joints * ((1 << 20) + (uint64_t)by), &clip, &fault));
        REFUSED_OUT(SIZE, clip, anthronet_clip_blend_masked(f->walk, f->walk, 1, &mask, LARGER(f->joints), &clip, &fault));
        REFUSED_OUT(SIZE, clip, anthronet_clip_additive(f->walk, f->walk, 1, exact, LARGER(f->joints), 0, NULL, 0, &clip, &fault));
        REFUSED_OUT(SIZE, clip, anthronet_clip_additive(f->walk, f->walk, 1, exact, f->joints, 0, &mask, LARGER(f->joints), &clip, &fault));
        REFUSED_OUT(SIZE, running, anthronet_job_start(f->model, requests, LARGER(1 << 20), &running, &fault));
        SIZED(export_options);
        export_options.clips = clips;
        export_options.clip_count = LARGER(1 << 20);
        REFUSED_OUT(SIZE, bytes, anthronet_export_memory(f->body, &export_options, TEXT("glb"), &bytes, &fault));
        SIZED(retarget);
        retarget.mapping_json = "{}";
        retarget.mapping_length = LARGER(1 << 20);
        REFUSED_OUT(SIZE, clip, anthronet_motion_retarget(f->motion, 0, f->body, &retarget, &clip, NULL, &fault));
        REFUSED_OUT(SIZE, request, anthronet_request_from_json("{}", LARGER(1 << 20), &request, &fault));
        REFUSED(SIZE, anthronet_request_set_measure(mine, "height", LARGER(1 << 20), 1.7, &fault));
        REFUSED_OUT(SIZE, model, anthronet_model_open_path("a", LARGER(1 << 20), &model, &fault));
        REFUSED_OUT(SIZE, model, anthronet_model_open_memory((const uint8_t *)"a", LARGER(1 << 30), &model, &fault));
        REFUSED_OUT(SIZE, motion, anthronet_motion_open_memory((const uint8_t *)"a", LARGER(1 << 30), TEXT("a.bvh"), NULL, &motion, &fault));
    }
    free(floats);
    free(exact);
    free(pose);
    anthronet_request_free(mine);
}

void test_strides(const fixture *f) {
    static const uint64_t NO_STRIDES[] = {1, 4, 11, UINT64_MAX, UINT64_MAX / 2, (uint64_t)1 << 62};
    anthronet_view view;
    anthronet_mesh *mesh = NULL;
    unsigned char *buffer;
    double metres[MEASURES];
    size_t bytes, i;
    uint32_t vertices = 0;
    anthronet_mesh_options options;
    SIZED(options);
    options.lod = 3;
    OK(anthronet_model_vertex_count(f->model, 3, &vertices, &fault));
    OK(anthronet_mesh_new(f->body, &options, &mesh, &fault));
    OK(anthronet_mesh_data(mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &view, &fault));
    bytes = (size_t)view.rows * 12;
    buffer = (unsigned char *)room(bytes);
    fill(buffer, bytes);
    for (i = 0; i < LENGTH(NO_STRIDES); i++) {
        REFUSED(SIZE, anthronet_mesh_read(mesh, 0, 0, buffer, bytes, NO_STRIDES[i], &fault));
        REFUSED_OUT(SIZE, metres, anthronet_measure_mesh(f->model, buffer, vertices, NO_STRIDES[i], 0, metres, MEASURES, NULL, &fault));
    }
    REFUSED(SIZE, anthronet_mesh_read(mesh, 0, 0, buffer, bytes - 1, 0, &fault));
    REFUSED(SIZE, anthronet_mesh_read(mesh, 0, 0, buffer, bytes, 13, &fault));
    REFUSED(SIZE, anthronet_mesh_read(mesh, 0, 0, buffer, 0, 0, &fault));
    REFUSED(SIZE, anthronet_mesh_read(mesh, 0, 0, NULL, 0, 0, &fault));
    CHECK(is_filled(buffer, bytes), "a refused buffer is written to");
    /* Exactly enough, at an odd address: rows are bytes. */
    OK(anthronet_mesh_read(mesh, 0, 0, buffer, bytes, 12, &fault));
    CHECK(memcmp(buffer, view.data, bytes) == 0, "rows");
    /* Nothing fits nowhere. */
    OK(anthronet_mesh_read(mesh, 0, ANTHRONET_ATTRIBUTE_QUADS, NULL, 0, 0, &fault));
    anthronet_mesh_free(mesh);
    free(buffer);
}

void test_texts(const fixture *f) {
    static const char *const NOT_UTF8[] = {"\xFF", "a\xC3", "\xED\xA0\x80", "\xF8\x88\x80\x80\x80", "\xC0\x80"};
    static const char *const NO_JSON[] = {"", "{", "[]", "null", "{\"sex\": 3}", "{\"sex\": \"neither\"}", "{\"measures\": {\"heigth\": 1.7}}",
                                          "{\"measures\": {\"height\": \"tall\"}}", "{\"measures\": {\"height\": 1e999}}",
                                          "{\"seed\": -1}", "{\"seed\": 1e30}", "{\"more\": 1}", "{} {}"};
    anthronet_request *request, *mine = NULL;
    anthronet_model *model;
    anthronet_motion *motion;
    anthronet_clip *clip;
    anthronet_bytes *bytes;
    uint32_t number;
    double metres[MEASURES];
    char deep[4096];
    size_t i;
    OK(anthronet_request_new(&mine, &fault));
    for (i = 0; i < LENGTH(NOT_UTF8); i++) {
        const char *bad = NOT_UTF8[i];
        uint64_t length = strlen(bad);
        const int32_t code = ANTHRONET_ERROR_TEXT;
        REFUSED_OUT(code, request, anthronet_request_from_json(bad, length, &request, &fault));
        REFUSED_OUT(code, number, anthronet_measure_index(bad, length, &number, &fault));
        REFUSED(code, anthronet_request_set_measure(mine, bad, length, 1, &fault));
        REFUSED_OUT(code, model, anthronet_model_open_path(bad, length, &model, &fault));
        REFUSED_OUT(code, motion, anthronet_motion_open_path(bad, length, NULL, &motion, &fault));
        REFUSED_OUT(code, motion, anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), bad, length, NULL, &motion, &fault));
        REFUSED_OUT(code, clip, anthronet_clip_builtin(bad, length, f->body, &clip, &fault));
        REFUSED_OUT(code, bytes, anthronet_export_memory(f->body, NULL, bad, length, &bytes, &fault));
        REFUSED(code, anthronet_export_path(f->body, NULL, bad, length, &fault));
        REFUSED_OUT(code, metres, anthronet_measure_file(f->model, bad, length, metres, MEASURES, NULL, &fault));
    }
    for (i = 0; i < LENGTH(NO_JSON); i++) FAILS_OUT(request, anthronet_request_from_json(NO_JSON[i], strlen(NO_JSON[i]), &request, &fault));
    memset(deep, '[', sizeof deep);
    FAILS_OUT(request, anthronet_request_from_json(deep, sizeof deep, &request, &fault));
    /* A message longer than there is room for is cut, ended, and still UTF-8. */
    for (i = 0; i + 1 < sizeof deep; i += 2) memcpy(deep + i, "\xC3\xA4", 2);
    FAILS_OUT(number, anthronet_measure_index(deep, sizeof deep, &number, &fault));
    i = strlen(fault.message);
    CHECK(i >= sizeof fault.message - 2 && i < sizeof fault.message && (unsigned char)fault.message[i - 1] == 0xA4, "cut at %u", (unsigned)i);
    FAILS_OUT(clip, anthronet_clip_builtin(TEXT("fly"), f->body, &clip, &fault));
    FAILS_OUT(clip, anthronet_clip_builtin(NULL, 0, f->body, &clip, &fault));
    FAILS_OUT(bytes, anthronet_export_memory(f->body, NULL, TEXT("png"), &bytes, &fault));
    FAILS_OUT(bytes, anthronet_export_memory(f->body, NULL, NULL, 0, &bytes, &fault));
    /* A text may hold a zero: it is not the end. */
    FAILS_OUT(number, anthronet_measure_index("height\0", 7, &number, &fault));
    FAILS_OUT(model, anthronet_model_open_path("a\0b", 3, &model, &fault));
    anthronet_request_free(mine);
}
