/* Clips and motions. */

#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static anthronet_clip_info info_of(const anthronet_clip *clip) {
    anthronet_clip_info info;
    SIZED(info);
    OK(anthronet_clip_describe(clip, &info, &fault));
    return info;
}

/* All frames of a clip. */
static anthronet_transform *baked(const fixture *f, const anthronet_clip *clip, uint32_t relative, uint64_t *out_count) {
    uint64_t count = (uint64_t)info_of(clip).frame_count * f->joints;
    anthronet_transform *frames = (anthronet_transform *)room((size_t)count * sizeof *frames);
    OK(anthronet_clip_bake(clip, relative, ANTHRONET_SPACE_GLTF, frames, count, &fault));
    if (out_count != NULL) *out_count = count;
    return frames;
}

/* The largest difference of two transforms; a quaternion and its negative are the same rotation. */
static double apart(const anthronet_transform *a, const anthronet_transform *b) {
    double dot = 0, worst = 0;
    int k;
    for (k = 0; k < 4; k++) dot += (double)a->rotation[k] * b->rotation[k];
    for (k = 0; k < 4; k++) worst = fmax(worst, fabs(a->rotation[k] - (dot < 0 ? -1.0 : 1.0) * b->rotation[k]));
    for (k = 0; k < 3; k++) worst = fmax(worst, fabs((double)a->translation[k] - b->translation[k]));
    return worst;
}

static double all_apart(const anthronet_transform *a, const anthronet_transform *b, uint64_t count) {
    double worst = 0;
    uint64_t i;
    for (i = 0; i < count; i++) worst = fmax(worst, apart(&a[i], &b[i]));
    return worst;
}

static void sample(const fixture *f, const anthronet_clip *clip, double seconds, uint32_t wrap, uint32_t relative,
                   uint32_t space, anthronet_transform *pose) {
    OK(anthronet_clip_sample(clip, NULL, seconds, wrap, relative, space, pose, f->joints, &fault));
}

static anthronet_transform *pose_room(const fixture *f) {
    return (anthronet_transform *)room(f->joints * sizeof(anthronet_transform));
}

void test_builtin_clips(const fixture *f) {
    uint32_t i, walks = 0, count = anthronet_clip_builtin_count();
    CHECK(count >= 5, "%u built-in clips", count);
    for (i = 0; i < count; i++) {
        anthronet_text name;
        anthronet_clip *clip = NULL;
        anthronet_clip_info info;
        OK(anthronet_clip_builtin_name(i, &name, &fault));
        walks += (uint32_t)is_text(name, "walk");
        if (f->few && !is_text(name, "idle")) continue;
        OK(anthronet_clip_builtin(name.data, name.length, f->body, &clip, &fault));
        info = info_of(clip);
        CHECK(info.frame_count > 1 && info.joint_count == f->joints && info.reserved == 0, "clip %u", i);
        CHECK(fabs(info.duration - (info.frame_count - 1) / info.frames_per_second) < 1e-9, "%f s", info.duration);
        CHECK(info.name.length == name.length && memcmp(info.name.data, name.data, name.length) == 0, "its name");
        anthronet_clip_free(clip);
    }
    CHECK(walks == 1, "%u clips are called walk", walks);
}

void test_sample(const fixture *f) {
    anthronet_clip_info info = info_of(f->walk);
    uint64_t count = 0;
    anthronet_transform *frames = baked(f, f->walk, ANTHRONET_RELATIVE_TO_PARENT, &count), *pose = pose_room(f), *model = pose_room(f);
    uint32_t j, frame = info.frame_count / 2;
    double at = frame / info.frames_per_second;
    int k;
    /* On a frame the sample is the frame; between two it is between. */
    sample(f, f->walk, at, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    CHECK(all_apart(pose, frames + (size_t)frame * f->joints, f->joints) < 1e-6, "frame %u", frame);
    sample(f, f->walk, 1e6, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    CHECK(all_apart(pose, frames + count - f->joints, f->joints) < 1e-6, "long after the end");
    sample(f, f->walk, at + 3 * info.duration, ANTHRONET_WRAP_LOOP, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    CHECK(all_apart(pose, frames + (size_t)frame * f->joints, f->joints) < 1e-4, "the fourth round");
    sample(f, f->walk, at + info.duration, ANTHRONET_WRAP_ROOT_MOTION, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_GLTF, pose);
    sample(f, f->walk, at, ANTHRONET_WRAP_ROOT_MOTION, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_GLTF, model);
    CHECK(pose[5].translation[2] - model[5].translation[2] > 0.5f, "a round of walking goes %f m",
          (double)(pose[5].translation[2] - model[5].translation[2]));
    /* Unity's and Blender's space hold the same points. */
    sample(f, f->walk, at, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_UNITY, pose);
    for (j = 0; j < f->joints; j++) {
        for (k = 0; k < 3; k++) {
            CHECK(fabsf(pose[j].translation[k] - (k == 0 ? -1 : 1) * model[j].translation[k]) < 1e-5f, "joint %u in Unity", j);
        }
    }
    sample(f, f->walk, at, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_BLENDER, pose);
    for (j = 0; j < f->joints; j++) {
        CHECK(fabsf(pose[j].translation[0] - model[j].translation[0]) < 1e-5f &&
                  fabsf(pose[j].translation[1] + model[j].translation[2]) < 1e-5f &&
                  fabsf(pose[j].translation[2] - model[j].translation[1]) < 1e-5f,
              "joint %u in Blender", j);
    }
    free(frames);
    free(pose);
    free(model);
}

void test_clips_made_of_clips(const fixture *f) {
    anthronet_clip_info info = info_of(f->walk);
    anthronet_clip *made = NULL, *idle = NULL;
    anthronet_transform *pose = pose_room(f), *other = pose_room(f), *walked = pose_room(f);
    float *mask = (float *)room(f->joints * sizeof *mask);
    uint32_t above = 0, i;
    double off, most = 0;
    OK(anthronet_clip_resample(f->walk, 2 * info.frames_per_second, &made, &fault));
    CHECK(info_of(made).frame_count == 2 * info.frame_count - 1 && fabs(info_of(made).duration - info.duration) < 1e-9,
          "twice the rate: %u frames", info_of(made).frame_count);
    anthronet_clip_free(made);
    OK(anthronet_clip_in_place(f->walk, &made, &fault));
    sample(f, made, 0, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_GLTF, pose);
    sample(f, made, info.duration, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_GLTF, other);
    CHECK(fabsf(pose[5].translation[2] - other[5].translation[2]) < 0.05f, "walks away from its place by %f m",
          (double)(pose[5].translation[2] - other[5].translation[2]));
    anthronet_clip_free(made);
    OK(anthronet_clip_builtin(TEXT("idle"), f->body, &idle, &fault));
    OK(anthronet_clip_blend(f->walk, idle, 0.0f, &made, &fault));
    sample(f, made, 0.2, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    sample(f, f->walk, 0.2, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, other);
    CHECK(all_apart(pose, other, f->joints) < 1e-3, "weight 0 is off the first by %g", all_apart(pose, other, f->joints));
    anthronet_clip_free(made);
    OK(anthronet_clip_blend(f->walk, idle, 1.0f, &made, &fault));
    sample(f, made, 0, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    sample(f, idle, 0, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, other);
    CHECK(all_apart(pose, other, f->joints) < 1e-3, "weight 1 is off the second by %g", all_apart(pose, other, f->joints));
    anthronet_clip_free(made);
    /* The upper body stands, the legs walk. */
    OK(anthronet_clip_joint_mask(f->walk, TEXT("spine_01"), mask, f->joints, &fault));
    for (i = 0; i < f->joints; i++) above += mask[i] == 1;
    CHECK(above > 5 && above < f->joints - 5, "%u joints of %u are above the waist", above, f->joints);
    OK(anthronet_clip_blend_masked(f->walk, idle, 1.0f, mask, f->joints, &made, &fault));
    sample(f, made, 0.3, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    sample(f, idle, 0.3, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, other);
    sample(f, f->walk, 0.3, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, walked);
    for (i = 0; i < f->joints; i++) {
        off = all_apart(&pose[i], mask[i] == 1 ? &other[i] : &walked[i], 1);
        if (!CHECK(off < 1e-3, "joint %u of a masked blend is off by %g", i, off)) break;
    }
    anthronet_clip_free(made);
    /* A layer against its own pose at 0.3 s adds nothing there; by default its first frame adds nothing at 0 s. */
    OK(anthronet_clip_additive(idle, f->walk, 1.0f, walked, f->joints, ANTHRONET_SPACE_GLTF, NULL, 0, &made, &fault));
    sample(f, made, 0.3, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    CHECK(all_apart(pose, other, f->joints) < 1e-3, "nothing added is %g", all_apart(pose, other, f->joints));
    anthronet_clip_free(made);
    OK(anthronet_clip_additive(idle, f->walk, 1.0f, NULL, 0, ANTHRONET_SPACE_GLTF, mask, f->joints, &made, &fault));
    sample(f, made, 0.3, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    for (i = 0; i < f->joints; i++) {
        double moved = all_apart(&pose[i], &other[i], 1);
        if (mask[i] == 0) CHECK(moved < 1e-3, "joint %u is not of the layer and is off by %g", i, moved);
        else most = fmax(most, moved);
    }
    CHECK(most > 0.01, "the layer moves nothing above the waist: %g", most);
    anthronet_clip_free(made);
    OK(anthronet_clip_crossfade(f->walk, idle, 0.25, &made, &fault));
    CHECK(fabs(info_of(made).duration - (info.duration + info_of(idle).duration - 0.25)) < 0.1, "%f s",
          info_of(made).duration);
    anthronet_clip_free(made);
    OK(anthronet_clip_looped(idle, 0.25, &made, &fault));
    sample(f, made, 0, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, pose);
    sample(f, made, info_of(made).duration, ANTHRONET_WRAP_ONCE, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_GLTF, other);
    CHECK(all_apart(pose, other, f->joints) < 0.02, "the end misses the beginning by %g", all_apart(pose, other, f->joints));
    anthronet_clip_free(made);
    anthronet_clip_free(idle);
    free(pose);
    free(walked);
    free(mask);
    free(other);
}

/* What was baked in a space makes the clip again. */
void test_clip_of_poses(const fixture *f) {
    anthronet_clip_info info = info_of(f->walk);
    uint64_t count = (uint64_t)info.frame_count * f->joints;
    anthronet_transform *there = (anthronet_transform *)room((size_t)count * sizeof *there), *again, *expected;
    anthronet_clip *clip = NULL;
    OK(anthronet_clip_bake(f->walk, ANTHRONET_RELATIVE_TO_PARENT, ANTHRONET_SPACE_UNITY, there, count, &fault));
    OK(anthronet_clip_from_poses(f->body, TEXT("mine"), info.frames_per_second, ANTHRONET_SPACE_UNITY, there, count, &clip, &fault));
    CHECK(is_text(info_of(clip).name, "mine") && info_of(clip).frame_count == info.frame_count, "name or frames");
    again = baked(f, clip, ANTHRONET_RELATIVE_TO_PARENT, NULL);
    expected = baked(f, f->walk, ANTHRONET_RELATIVE_TO_PARENT, NULL);
    CHECK(all_apart(again, expected, count) < 1e-5, "off by %g", all_apart(again, expected, count));
    anthronet_clip_free(clip);
    free(there);
    free(again);
    free(expected);
}

void test_motion_files(const fixture *f) {
    const char *path = path_in(f, "steps.bvh");
    anthronet_motion *from_path = NULL;
    anthronet_motion_options read;
    anthronet_retarget_options options;
    anthronet_clip *clip = NULL;
    anthronet_bytes *json = NULL;
    anthronet_text name;
    uint32_t clips = 0;
    write_file(path, BVH, strlen(BVH));
    SIZED(read);
    read.metres_per_unit = 0.01;
    read.up = ANTHRONET_UP_Y;
    read.frames_per_second = 10;
    read.person = 1;
    OK(anthronet_motion_open_path(path, strlen(path), &read, &from_path, &fault));
    OK(anthronet_motion_clip_count(from_path, &clips, &fault));
    CHECK(clips == 1, "%u clips", clips);
    OK(anthronet_motion_clip_name(from_path, 0, &name, &fault));
    CHECK(is_text(name, "steps"), "the clip has another name than its file");
    OK(anthronet_motion_report(from_path, &json, &fault));
    CHECK(contains_freed(json, "BVH"), "the report names no format");
    OK(anthronet_motion_retarget(from_path, 0, f->body, NULL, &clip, NULL, &fault));
    CHECK(info_of(clip).frame_count == 3 && fabs(info_of(clip).frames_per_second - 10) < 1e-9, "%u frames at %f",
          info_of(clip).frame_count, info_of(clip).frames_per_second);
    anthronet_clip_free(clip);
    clip = NULL;
    SIZED(options);
    options.fingers = ANTHRONET_FINGERS_REST;
    options.no_limits = options.no_feet = options.in_place = options.root_motion = 1;
    options.frames_per_second = 60;
    options.mapping_json = "{\"Spine\": \"spine_01\", \"Head\": null}";
    options.mapping_length = (uint32_t)strlen(options.mapping_json);
    if (!OK(anthronet_motion_retarget(f->motion, 0, f->body, &options, &clip, &json, &fault))) return;
    CHECK(fabs(info_of(clip).frames_per_second - 60) < 1e-9, "%f frames per second", info_of(clip).frames_per_second);
    CHECK(contains_freed(json, "upperarm_l"), "the report drives no arm");
    anthronet_clip_free(clip);
    anthronet_motion_free(from_path);
}

/* The fixture's walk, as another program's skeleton with other names, comes back as it was. */
void test_motion_of_poses(const fixture *f) {
    anthronet_clip_info info = info_of(f->walk);
    uint64_t count = 0;
    anthronet_transform *frames = baked(f, f->walk, ANTHRONET_RELATIVE_TO_PARENT, &count), *rest = pose_room(f), *again, *places;
    anthronet_text *names = (anthronet_text *)room(f->joints * sizeof *names);
    int32_t *parents = (int32_t *)room(f->joints * sizeof *parents);
    anthronet_joint *joints = (anthronet_joint *)room(f->joints * sizeof *joints);
    anthronet_motion_source source;
    anthronet_retarget_options options;
    anthronet_motion *motion = NULL;
    anthronet_clip *clip = NULL;
    uint64_t compared, i;
    uint32_t j;
    double off = 0;
    int k;
    OK(anthronet_body_joints(f->body, ANTHRONET_SPACE_GLTF, joints, f->joints, &fault));
    for (j = 0; j < f->joints; j++) {
        OK(anthronet_body_joint_name(f->body, j, ANTHRONET_NAMES_NATIVE, &names[j], &fault));
        parents[j] = joints[j].parent;
        rest[j] = joints[j].parent_from_joint;
    }
    SIZED(source);
    source.joint_count = f->joints;
    source.frame_count = info.frame_count;
    source.frames_per_second = info.frames_per_second;
    source.name = info.name;
    source.joint_names = names;
    source.parents = parents;
    source.rest = rest;
    source.frames = frames;
    OK(anthronet_motion_from_poses(&source, &motion, &fault));
    SIZED(options);
    options.no_limits = options.no_feet = 1;
    OK(anthronet_motion_retarget(motion, 0, f->body, &options, &clip, NULL, &fault));
    if (clip != NULL) {
        again = baked(f, clip, ANTHRONET_RELATIVE_TO_MODEL, &compared);
        places = baked(f, f->walk, ANTHRONET_RELATIVE_TO_MODEL, NULL);
        /* Twist joints are the retargeter's own, so places are compared, not rotations; and the pelvis has gone the
         * way, not the root. */
        for (i = 0; compared == count && i < count; i++) {
            if (i % f->joints == 0) continue;
            for (k = 0; k < 3; k++) off = fmax(off, fabs((double)again[i].translation[k] - places[i].translation[k]));
        }
        CHECK(compared == count && off < 0.01, "%lu transforms of %lu, off by %f m", (unsigned long)compared,
              (unsigned long)count, off);
        free(again);
        free(places);
    }
    anthronet_clip_free(clip);
    anthronet_motion_free(motion);
    free(frames);
    free(rest);
    free(names);
    free(parents);
    free(joints);
}
