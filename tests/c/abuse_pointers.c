/* NULL for every pointer of every function, and pointers that are not aligned. */

#include "abuse.h"

#include <stdlib.h>
#include <string.h>

#define NONE ANTHRONET_ERROR_POINTER

void test_null_in_makers(const fixture *f) {
    anthronet_model *model;
    anthronet_bytes *bytes;
    anthronet_text text;
    const uint8_t *data;
    uint64_t length;
    uint32_t number;
    double low, high, metres[MEASURES];
    REFUSED(NONE, anthronet_version(NULL, &fault));
    REFUSED(NONE, anthronet_model_open_embedded(NULL, &fault));
    REFUSED(NONE, anthronet_model_open_default(NULL, &fault));
    REFUSED(NONE, anthronet_model_open_path(TEXT("model"), NULL, &fault));
    REFUSED_OUT(NONE, model, anthronet_model_open_path(NULL, 4, &model, &fault));
    REFUSED_OUT(NONE, model, anthronet_model_open_memory(NULL, 4, &model, &fault));
    REFUSED(NONE, anthronet_model_open_memory((const uint8_t *)"1234", 4, NULL, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_model_info(NULL, &bytes, &fault));
    REFUSED(NONE, anthronet_model_info(f->model, NULL, &fault));
    REFUSED_OUT(NONE, number, anthronet_model_latent_size(NULL, &number, &fault));
    REFUSED(NONE, anthronet_model_latent_size(f->model, NULL, &fault));
    REFUSED_OUT(NONE, number, anthronet_model_vertex_count(NULL, 0, &number, &fault));
    REFUSED(NONE, anthronet_model_vertex_count(f->model, 0, NULL, &fault));
    REFUSED_OUT(NONE, low, anthronet_model_measure_range(NULL, 0, &low, &high, &fault));
    REFUSED_OUT(NONE, high, anthronet_model_measure_range(f->model, 0, NULL, &high, &fault));
    REFUSED_OUT(NONE, low, anthronet_model_measure_range(f->model, 0, &low, NULL, &fault));
    REFUSED_OUT(NONE, length, anthronet_bytes_data(NULL, &data, &length, &fault));
    OK(anthronet_model_info(f->model, &bytes, &fault));
    REFUSED_OUT(NONE, length, anthronet_bytes_data(bytes, NULL, &length, &fault));
    REFUSED_OUT(NONE, data, anthronet_bytes_data(bytes, &data, NULL, &fault));
    anthronet_bytes_free(bytes);
    REFUSED(NONE, anthronet_measure_name(0, NULL, &fault));
    REFUSED_OUT(NONE, number, anthronet_measure_index(NULL, 6, &number, &fault));
    REFUSED(NONE, anthronet_measure_index(TEXT("height"), NULL, &fault));
    REFUSED_OUT(NONE, metres, anthronet_measure_mesh(NULL, metres, 1, 0, 0, metres, MEASURES, NULL, &fault));
    REFUSED_OUT(NONE, metres, anthronet_measure_mesh(f->model, NULL, 53514, 0, 0, metres, MEASURES, NULL, &fault));
    REFUSED(NONE, anthronet_measure_mesh(f->model, metres, 1, 0, 0, NULL, MEASURES, NULL, &fault));
    REFUSED_OUT(NONE, metres, anthronet_measure_file(NULL, TEXT("a.glb"), metres, MEASURES, NULL, &fault));
    REFUSED_OUT(NONE, metres, anthronet_measure_file(f->model, NULL, 5, metres, MEASURES, NULL, &fault));
    REFUSED(NONE, anthronet_measure_file(f->model, TEXT("a.glb"), NULL, MEASURES, NULL, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_measure_file_report(NULL, TEXT("a.glb"), &bytes, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_measure_file_report(f->model, NULL, 5, &bytes, &fault));
    REFUSED(NONE, anthronet_measure_file_report(f->model, TEXT("a.glb"), NULL, &fault));
    REFUSED(NONE, anthronet_clip_builtin_name(0, NULL, &fault));
    REFUSED(NONE, anthronet_humanoid_bone_at(0, NULL, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INDEX, text, anthronet_measure_name(MEASURES, &text, &fault));
    /* Nothing to free. */
    anthronet_bytes_free(NULL);
    anthronet_model_free(NULL);
    anthronet_request_free(NULL);
    anthronet_body_free(NULL);
    anthronet_job_free(NULL);
    anthronet_mesh_free(NULL);
    anthronet_skinner_free(NULL);
    anthronet_context_free(NULL);
    anthronet_clip_free(NULL);
    anthronet_motion_free(NULL);
}

void test_null_in_requests(const fixture *f) {
    anthronet_request *request = NULL, *out;
    anthronet_bytes *bytes;
    double metres[MEASURES];
    uint8_t given[MEASURES];
    double latent[1] = {0};
    ZERO(metres);
    ZERO(given);
    OK(anthronet_request_new(&request, &fault));
    REFUSED(NONE, anthronet_request_new(NULL, &fault));
    REFUSED(NONE, anthronet_request_from_json(TEXT("{}"), NULL, &fault));
    REFUSED_OUT(NONE, out, anthronet_request_from_json(NULL, 2, &out, &fault));
    REFUSED_OUT(NONE, out, anthronet_request_copy(NULL, &out, &fault));
    REFUSED(NONE, anthronet_request_copy(f->request, NULL, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_request_to_json(NULL, &bytes, &fault));
    REFUSED(NONE, anthronet_request_to_json(f->request, NULL, &fault));
    REFUSED(NONE, anthronet_request_set_sex(NULL, 1, &fault));
    REFUSED(NONE, anthronet_request_set_measure(NULL, TEXT("height"), 1.7, &fault));
    REFUSED(NONE, anthronet_request_set_measure(request, NULL, 6, 1.7, &fault));
    REFUSED(NONE, anthronet_request_set_measures(NULL, metres, given, MEASURES, &fault));
    REFUSED(NONE, anthronet_request_set_measures(request, NULL, given, MEASURES, &fault));
    REFUSED(NONE, anthronet_request_set_measures(request, metres, NULL, MEASURES, &fault));
    REFUSED_OUT(NONE, metres, anthronet_request_measures(NULL, metres, given, MEASURES, &fault));
    REFUSED_OUT(NONE, given, anthronet_request_measures(request, NULL, given, MEASURES, &fault));
    REFUSED_OUT(NONE, metres, anthronet_request_measures(request, metres, NULL, MEASURES, &fault));
    REFUSED(NONE, anthronet_request_unset_measure(NULL, 0, &fault));
    REFUSED(NONE, anthronet_request_set_seed(NULL, 0, &fault));
    REFUSED(NONE, anthronet_request_set_latent(NULL, latent, 1, &fault));
    REFUSED(NONE, anthronet_request_set_latent(request, NULL, 1, &fault));
    REFUSED(NONE, anthronet_request_set_fill(NULL, 0, &fault));
    REFUSED(NONE, anthronet_request_set_nearest(NULL, 0, &fault));
    anthronet_request_free(request);
}

void test_null_in_bodies(const fixture *f) {
    anthronet_body *body;
    anthronet_bytes *bytes;
    anthronet_measure_report report[MEASURES];
    anthronet_body_summary summary;
    anthronet_job *job;
    anthronet_job_progress progress;
    anthronet_joint joint;
    anthronet_text text;
    double latent;
    const anthronet_request *requests[2];
    requests[0] = f->request;
    requests[1] = NULL;
    REFUSED_OUT(NONE, body, anthronet_generate(NULL, f->request, &body, &fault));
    REFUSED_OUT(NONE, body, anthronet_generate(f->model, NULL, &body, &fault));
    REFUSED(NONE, anthronet_generate(f->model, f->request, NULL, &fault));
    REFUSED_OUT(NONE, body, anthronet_interpolate(NULL, f->request, f->request, 0.5, &body, &fault));
    REFUSED_OUT(NONE, body, anthronet_interpolate(f->model, NULL, f->request, 0.5, &body, &fault));
    REFUSED_OUT(NONE, body, anthronet_interpolate(f->model, f->request, NULL, 0.5, &body, &fault));
    REFUSED(NONE, anthronet_interpolate(f->model, f->request, f->request, 0.5, NULL, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_body_report(NULL, &bytes, &fault));
    REFUSED(NONE, anthronet_body_report(f->body, NULL, &fault));
    REFUSED_OUT(NONE, report, anthronet_body_measures(NULL, report, MEASURES, &fault));
    REFUSED(NONE, anthronet_body_measures(f->body, NULL, MEASURES, &fault));
    SIZED(summary);
    REFUSED(NONE, anthronet_body_summarise(NULL, &summary, &fault));
    REFUSED(NONE, anthronet_body_summarise(f->body, NULL, &fault));
    REFUSED_OUT(NONE, latent, anthronet_body_latent(NULL, &latent, 1, &fault));
    REFUSED_OUT(NONE, job, anthronet_job_start(NULL, requests, 1, &job, &fault));
    REFUSED_OUT(NONE, job, anthronet_job_start(f->model, NULL, 1, &job, &fault));
    REFUSED_OUT(NONE, job, anthronet_job_start(f->model, requests, 2, &job, &fault));
    REFUSED(NONE, anthronet_job_start(f->model, requests, 1, NULL, &fault));
    SIZED(progress);
    REFUSED(NONE, anthronet_job_poll(NULL, &progress, &fault));
    REFUSED(NONE, anthronet_job_cancel(NULL, &fault));
    REFUSED_OUT(NONE, body, anthronet_job_take(NULL, 0, &body, &fault));
    OK(anthronet_job_start(f->model, requests, 1, &job, &fault));
    REFUSED(NONE, anthronet_job_poll(job, NULL, &fault));
    REFUSED(NONE, anthronet_job_take(job, 0, NULL, &fault));
    anthronet_job_free(job);
    REFUSED_OUT(NONE, joint, anthronet_body_joints(NULL, 0, &joint, 1, &fault));
    REFUSED(NONE, anthronet_body_joints(f->body, 0, NULL, f->joints, &fault));
    REFUSED_OUT(NONE, text, anthronet_body_joint_name(NULL, 0, 0, &text, &fault));
    REFUSED(NONE, anthronet_body_joint_name(f->body, 0, 0, NULL, &fault));
}

void test_null_in_meshes(const fixture *f) {
    anthronet_mesh *mesh;
    anthronet_mesh_part part;
    anthronet_view view;
    anthronet_skinner *skinner;
    anthronet_bytes *bytes;
    anthronet_export_options options;
    const anthronet_clip *clips[1];
    uint32_t number;
    char row[12];
    REFUSED_OUT(NONE, mesh, anthronet_mesh_new(NULL, NULL, &mesh, &fault));
    REFUSED(NONE, anthronet_mesh_new(f->body, NULL, NULL, &fault));
    REFUSED(NONE, anthronet_mesh_update(NULL, f->body, &fault));
    OK(anthronet_mesh_new(f->body, NULL, &mesh, &fault));
    REFUSED(NONE, anthronet_mesh_update(mesh, NULL, &fault));
    OK(anthronet_mesh_part_count(mesh, &number, &fault));
    anthronet_mesh_free(mesh);
    REFUSED_OUT(NONE, number, anthronet_mesh_part_count(NULL, &number, &fault));
    REFUSED(NONE, anthronet_mesh_part_count(f->mesh, NULL, &fault));
    SIZED(part);
    REFUSED(NONE, anthronet_mesh_describe_part(NULL, 0, &part, &fault));
    REFUSED(NONE, anthronet_mesh_describe_part(f->mesh, 0, NULL, &fault));
    REFUSED_OUT(NONE, view, anthronet_mesh_data(NULL, 0, 0, &view, &fault));
    REFUSED(NONE, anthronet_mesh_data(f->mesh, 0, 0, NULL, &fault));
    REFUSED_OUT(NONE, row, anthronet_mesh_read(NULL, 0, 0, row, 12, 0, &fault));
    REFUSED(NONE, anthronet_mesh_read(f->mesh, 0, 0, NULL, 1 << 24, 0, &fault));
    REFUSED_OUT(NONE, skinner, anthronet_skinner_new(NULL, 0, &skinner, &fault));
    REFUSED(NONE, anthronet_skinner_new(f->mesh, 0, NULL, &fault));
    REFUSED_OUT(NONE, number, anthronet_skinner_vertex_count(NULL, &number, &fault));
    REFUSED(NONE, anthronet_skinner_vertex_count(f->skinner, NULL, &fault));
    REFUSED(NONE, anthronet_skin(NULL, NULL, 1, &fault));
    REFUSED(NONE, anthronet_context_new(NULL, &fault));
    REFUSED(NONE, anthronet_export_path(NULL, NULL, TEXT("a.glb"), &fault));
    REFUSED(NONE, anthronet_export_path(f->body, NULL, NULL, 5, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_export_memory(NULL, NULL, TEXT("glb"), &bytes, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_export_memory(f->body, NULL, NULL, 3, &bytes, &fault));
    REFUSED(NONE, anthronet_export_memory(f->body, NULL, TEXT("glb"), NULL, &fault));
    SIZED(options);
    options.clip_count = 1;
    REFUSED_OUT(NONE, bytes, anthronet_export_memory(f->body, &options, TEXT("glb"), &bytes, &fault));
    clips[0] = NULL;
    options.clips = clips;
    REFUSED_OUT(NONE, bytes, anthronet_export_memory(f->body, &options, TEXT("glb"), &bytes, &fault));
}

void test_blend_shape_arguments(const fixture *f) {
    anthronet_mesh_options options;
    anthronet_mesh *mesh = NULL;
    anthronet_text text;
    anthronet_view view;
    uint32_t number;
    char row[12];
    SIZED(options);
    options.lod = 3;
    OK(anthronet_mesh_new(f->body, &options, &mesh, &fault));
    REFUSED(NONE, anthronet_mesh_add_blend_shape(NULL, TEXT("a"), f->body, &fault));
    REFUSED(NONE, anthronet_mesh_add_blend_shape(mesh, NULL, 1, f->body, &fault));
    REFUSED(NONE, anthronet_mesh_add_blend_shape(mesh, TEXT("a"), NULL, &fault));
    REFUSED(ANTHRONET_ERROR_TEXT, anthronet_mesh_add_blend_shape(mesh, TEXT("\xFF"), f->body, &fault));
    REFUSED(ANTHRONET_ERROR_SIZE, anthronet_mesh_add_blend_shape(mesh, "a", UINT64_MAX, f->body, &fault));
    REFUSED_OUT(NONE, number, anthronet_mesh_blend_shape_count(NULL, &number, &fault));
    OK(anthronet_mesh_blend_shape_count(mesh, &number, &fault));
    CHECK(number == 0, "what was refused is there");
    OK(anthronet_mesh_add_blend_shape(mesh, TEXT("a"), f->body, &fault));
    REFUSED(NONE, anthronet_mesh_blend_shape_count(mesh, NULL, &fault));
    REFUSED_OUT(NONE, text, anthronet_mesh_blend_shape_name(NULL, 0, &text, &fault));
    REFUSED(NONE, anthronet_mesh_blend_shape_name(mesh, 0, NULL, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INDEX, text, anthronet_mesh_blend_shape_name(mesh, 1, &text, &fault));
    REFUSED_OUT(NONE, view, anthronet_mesh_blend_shape_data(NULL, 0, 0, 0, &view, &fault));
    REFUSED(NONE, anthronet_mesh_blend_shape_data(mesh, 0, 0, 0, NULL, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INDEX, view, anthronet_mesh_blend_shape_data(mesh, 1, 0, 0, &view, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INDEX, view, anthronet_mesh_blend_shape_data(mesh, 0, 99, 0, &view, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_ENUM, view, anthronet_mesh_blend_shape_data(mesh, 0, 0, 2, &view, &fault));
    REFUSED_OUT(NONE, row, anthronet_mesh_read_blend_shape(NULL, 0, 0, 0, row, 12, 0, &fault));
    REFUSED(NONE, anthronet_mesh_read_blend_shape(mesh, 0, 0, 0, NULL, 1 << 24, 0, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_SIZE, row, anthronet_mesh_read_blend_shape(mesh, 0, 0, 0, row, 12, 0, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_SIZE, row, anthronet_mesh_read_blend_shape(mesh, 0, 0, 0, row, 12, 11, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INDEX, row, anthronet_mesh_read_blend_shape(mesh, 7, 0, 0, row, 12, 0, &fault));
    anthronet_mesh_free(mesh);
}

void test_null_in_clips(const fixture *f) {
    anthronet_clip *clip;
    anthronet_clip_info info;
    anthronet_transform pose[1];
    float *mask = (float *)room(f->joints * sizeof *mask);
    uint32_t i;
    SIZED(info);
    REFUSED_OUT(NONE, clip, anthronet_clip_builtin(NULL, 4, f->body, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_builtin(TEXT("walk"), NULL, &clip, &fault));
    REFUSED(NONE, anthronet_clip_builtin(TEXT("walk"), f->body, NULL, &fault));
    ZERO(pose);
    REFUSED_OUT(NONE, clip, anthronet_clip_from_poses(NULL, TEXT("a"), 30, 0, pose, 1, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_from_poses(f->body, NULL, 1, 30, 0, pose, 1, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, NULL, f->joints, &clip, &fault));
    REFUSED(NONE, anthronet_clip_from_poses(f->body, TEXT("a"), 30, 0, pose, 1, NULL, &fault));
    REFUSED(NONE, anthronet_clip_describe(NULL, &info, &fault));
    REFUSED(NONE, anthronet_clip_describe(f->walk, NULL, &fault));
    REFUSED_OUT(NONE, pose, anthronet_clip_sample(NULL, NULL, 0, 0, 0, 0, pose, 1, &fault));
    REFUSED(NONE, anthronet_clip_sample(f->walk, NULL, 0, 0, 0, 0, NULL, f->joints, &fault));
    REFUSED_OUT(NONE, pose, anthronet_clip_bake(NULL, 0, 0, pose, 1, &fault));
    OK(anthronet_clip_describe(f->walk, &info, &fault));
    REFUSED(NONE, anthronet_clip_bake(f->walk, 0, 0, NULL, (uint64_t)info.frame_count * f->joints, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_resample(NULL, 30, &clip, &fault));
    REFUSED(NONE, anthronet_clip_resample(f->walk, 30, NULL, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_in_place(NULL, &clip, &fault));
    REFUSED(NONE, anthronet_clip_in_place(f->walk, NULL, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_looped(NULL, 0.1, &clip, &fault));
    REFUSED(NONE, anthronet_clip_looped(f->walk, 0.1, NULL, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_blend(NULL, f->walk, 0, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_blend(f->walk, NULL, 0, &clip, &fault));
    REFUSED(NONE, anthronet_clip_blend(f->walk, f->walk, 0, NULL, &fault));
    for (i = 0; i < f->joints; i++) mask[i] = 1;
    REFUSED_OUT(NONE, clip, anthronet_clip_blend_masked(NULL, f->walk, 0, mask, f->joints, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_blend_masked(f->walk, NULL, 0, mask, f->joints, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_blend_masked(f->walk, f->walk, 0, NULL, f->joints, &clip, &fault));
    REFUSED(NONE, anthronet_clip_blend_masked(f->walk, f->walk, 0, mask, f->joints, NULL, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_additive(NULL, f->walk, 0, NULL, 0, 0, NULL, 0, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_additive(f->walk, NULL, 0, NULL, 0, 0, NULL, 0, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_additive(f->walk, f->walk, 0, NULL, f->joints, 0, NULL, 0, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_additive(f->walk, f->walk, 0, NULL, 0, 0, NULL, f->joints, &clip, &fault));
    REFUSED(NONE, anthronet_clip_additive(f->walk, f->walk, 0, NULL, 0, 0, NULL, 0, NULL, &fault));
    fill(mask, f->joints * sizeof *mask);
    REFUSED(NONE, anthronet_clip_joint_mask(NULL, TEXT("spine_01"), mask, f->joints, &fault));
    REFUSED(NONE, anthronet_clip_joint_mask(f->walk, NULL, 8, mask, f->joints, &fault));
    REFUSED(NONE, anthronet_clip_joint_mask(f->walk, TEXT("spine_01"), NULL, f->joints, &fault));
    REFUSED(ANTHRONET_ERROR_SIZE, anthronet_clip_joint_mask(f->walk, TEXT("spine_01"), mask, f->joints - 1, &fault));
    FAILS(anthronet_clip_joint_mask(f->walk, TEXT("tail"), mask, f->joints, &fault));
    CHECK(is_filled(mask, f->joints * sizeof *mask), "a refused mask is written");
    free(mask);
    REFUSED_OUT(NONE, clip, anthronet_clip_crossfade(NULL, f->walk, 0.1, &clip, &fault));
    REFUSED_OUT(NONE, clip, anthronet_clip_crossfade(f->walk, NULL, 0.1, &clip, &fault));
    REFUSED(NONE, anthronet_clip_crossfade(f->walk, f->walk, 0.1, NULL, &fault));
}

void test_null_in_motions(const fixture *f) {
    anthronet_motion *motion;
    anthronet_motion_source source;
    anthronet_retarget_options options;
    anthronet_clip *clip;
    anthronet_bytes *bytes;
    anthronet_text text;
    uint32_t number;
    const uint8_t *bvh = (const uint8_t *)BVH;
    REFUSED_OUT(NONE, motion, anthronet_motion_open_path(NULL, 5, NULL, &motion, &fault));
    REFUSED(NONE, anthronet_motion_open_path(TEXT("a.bvh"), NULL, NULL, &fault));
    REFUSED_OUT(NONE, motion, anthronet_motion_open_memory(NULL, 5, TEXT("a.bvh"), NULL, &motion, &fault));
    REFUSED_OUT(NONE, motion, anthronet_motion_open_memory(bvh, 9, NULL, 5, NULL, &motion, &fault));
    REFUSED(NONE, anthronet_motion_open_memory(bvh, strlen(BVH), TEXT("a.bvh"), NULL, NULL, &fault));
    SIZED(source);
    REFUSED_OUT(NONE, motion, anthronet_motion_from_poses(NULL, &motion, &fault));
    REFUSED(NONE, anthronet_motion_from_poses(&source, NULL, &fault));
    source.joint_count = source.frame_count = 1;
    source.frames_per_second = 30;
    REFUSED_OUT(NONE, motion, anthronet_motion_from_poses(&source, &motion, &fault));
    REFUSED_OUT(NONE, number, anthronet_motion_clip_count(NULL, &number, &fault));
    REFUSED(NONE, anthronet_motion_clip_count(f->motion, NULL, &fault));
    REFUSED_OUT(NONE, text, anthronet_motion_clip_name(NULL, 0, &text, &fault));
    REFUSED(NONE, anthronet_motion_clip_name(f->motion, 0, NULL, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_motion_report(NULL, &bytes, &fault));
    REFUSED(NONE, anthronet_motion_report(f->motion, NULL, &fault));
    REFUSED_OUT(NONE, clip, anthronet_motion_retarget(NULL, 0, f->body, NULL, &clip, NULL, &fault));
    REFUSED_OUT(NONE, clip, anthronet_motion_retarget(f->motion, 0, NULL, NULL, &clip, NULL, &fault));
    REFUSED_OUT(NONE, bytes, anthronet_motion_retarget(f->motion, 0, f->body, NULL, NULL, &bytes, &fault));
    SIZED(options);
    options.mapping_length = 7;
    REFUSED_OUT(NONE, clip, anthronet_motion_retarget(f->motion, 0, f->body, &options, &clip, NULL, &fault));
}

void test_crooked_pointers(const fixture *f) {
    anthronet_body *body;
    anthronet_mesh *mesh;
    anthronet_body_summary summary;
    anthronet_mesh_options options;
    anthronet_measure_report report[MEASURES + 1];
    anthronet_transform pose[2];
    double metres[MEASURES + 1];
    char storage[sizeof(anthronet_error) + 1];
    SIZED(summary);
    SIZED(options);
    ZERO(metres);
    REFUSED_OUT(NONE, body, anthronet_generate(CROOKED(anthronet_model *, f->model), f->request, &body, &fault));
    REFUSED_OUT(NONE, body, anthronet_generate(f->model, CROOKED(anthronet_request *, f->request), &body, &fault));
    REFUSED(NONE, anthronet_generate(f->model, f->request, CROOKED(anthronet_body **, &body), &fault));
    REFUSED(NONE, anthronet_body_summarise(f->body, CROOKED(anthronet_body_summary *, &summary), &fault));
    REFUSED_OUT(NONE, mesh, anthronet_mesh_new(f->body, CROOKED(anthronet_mesh_options *, &options), &mesh, &fault));
    REFUSED(NONE, anthronet_body_measures(f->body, CROOKED(anthronet_measure_report *, report), MEASURES, &fault));
    REFUSED(NONE, anthronet_request_set_latent(f->request, CROOKED(double *, metres), MEASURES, &fault));
    REFUSED(NONE, anthronet_clip_sample(f->walk, NULL, 0, 0, 0, 0, CROOKED(anthronet_transform *, pose), f->joints, &fault));
    /* The error itself may lie anywhere. */
    fill(storage, sizeof storage);
    CHECK(anthronet_generate(NULL, f->request, &body, CROOKED(anthronet_error *, storage)) == NONE, "another code");
    CHECK(strlen(storage + 1 + sizeof(int32_t)) > 0 && is_filled(storage, 1), "no message at an odd address");
}

void test_no_error_wanted(const fixture *f) {
    anthronet_body *body = NULL;
    anthronet_request *request = NULL;
    anthronet_error before, untouched;
    CHECK(anthronet_generate(NULL, f->request, &body, NULL) == NONE, "another code");
    CHECK(anthronet_request_from_json(TEXT("{"), &request, NULL) == ANTHRONET_ERROR_FILE ||
              anthronet_request_from_json(TEXT("{"), &request, NULL) == ANTHRONET_ERROR_REQUEST,
          "another code");
    /* Success leaves the error as it was. */
    fill(&before, sizeof before);
    untouched = before;
    CHECK(anthronet_generate(f->model, f->request, &body, &untouched) == ANTHRONET_OK, "no body");
    CHECK(memcmp(&before, &untouched, sizeof before) == 0, "an error is written without one");
    anthronet_body_free(body);
}
