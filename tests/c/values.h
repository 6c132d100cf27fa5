/* The tests of values, one file per family of functions. */

#ifndef VALUES_H
#define VALUES_H

#include "check.h"

void test_version(const fixture *f);
void test_model_open(const fixture *f);
void test_model_describes(const fixture *f);
void test_measures(const fixture *f);
void test_request(const fixture *f);
void test_generate(const fixture *f);
void test_latent(const fixture *f);
void test_interpolate(const fixture *f);
void test_log(const fixture *f);

void test_meshes(const fixture *f);
void test_mesh_options(const fixture *f);
void test_mesh_read(const fixture *f);
void test_mesh_update(const fixture *f);
void test_blend_shapes(const fixture *f);
void test_joints(const fixture *f);
void test_humanoid(const fixture *f);

void test_skin_at_rest(const fixture *f);
void test_skin_posed(const fixture *f);
void test_context(const fixture *f);
void test_skin_buffers(const fixture *f);

void test_builtin_clips(const fixture *f);
void test_sample(const fixture *f);
void test_clips_made_of_clips(const fixture *f);
void test_clip_of_poses(const fixture *f);
void test_motion_files(const fixture *f);
void test_motion_of_poses(const fixture *f);

void test_export_memory(const fixture *f);
void test_export_path(const fixture *f);
void test_job(const fixture *f);
void test_job_cancelled(const fixture *f);

#endif
