/* Skinning against its formula, computed here from the arrays of the mesh. */

#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static anthronet_skin_job job_of(const fixture *f, const anthronet_transform *pose, float *positions, uint64_t bytes) {
    anthronet_skin_job job;
    SIZED(job);
    job.skinner = f->skinner;
    job.joints = pose;
    job.joint_count = f->joints;
    job.positions = positions;
    job.position_bytes = bytes;
    return job;
}

static double largest_difference(const float *a, const float *b, uint64_t count) {
    double worst = 0;
    uint64_t i;
    for (i = 0; i < count; i++) worst = fmax(worst, fabs((double)a[i] - b[i]));
    return worst;
}

/* Positions of the fixture's mesh, and their number. */
static const float *bind_positions(const fixture *f, uint32_t *count) {
    anthronet_view view;
    uint32_t vertices = 0;
    OK(anthronet_mesh_data(f->mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &view, &fault));
    OK(anthronet_skinner_vertex_count(f->skinner, &vertices, &fault));
    CHECK(vertices == view.rows, "the skinner writes %u vertices, the mesh has %lu", vertices, (unsigned long)view.rows);
    *count = vertices;
    return (const float *)view.data;
}

void test_skin_at_rest(const fixture *f) {
    anthronet_transform *pose = rest_pose(f, f->body, ANTHRONET_SPACE_GLTF);
    uint32_t count = 0, method;
    const float *bind = bind_positions(f, &count);
    float *posed = (float *)room(12 * (size_t)count);
    for (method = ANTHRONET_SKIN_LINEAR; method <= ANTHRONET_SKIN_JOINT_TRANSLATION; method++) {
        anthronet_skin_job job = job_of(f, pose, posed, 12 * (uint64_t)count);
        job.method = method;
        memset(posed, 0xFF, 12 * (size_t)count);
        OK(anthronet_skin(NULL, &job, 1, &fault));
        CHECK(largest_difference(posed, bind, 3 * (uint64_t)count) < 2e-6, "method %u moves by %g m", method,
              largest_difference(posed, bind, 3 * (uint64_t)count));
    }
    free(posed);
    free(pose);
}

/* A transform's matrix times a vector of four, w being 1. */
static void move(const anthronet_transform *t, const double *v, double *out) {
    const float *q = t->rotation;
    double cross[3];
    int k;
    for (k = 0; k < 3; k++) {
        cross[k] = 2 * (q[(k + 1) % 3] * v[(k + 2) % 3] - q[(k + 2) % 3] * v[(k + 1) % 3]);
    }
    for (k = 0; k < 3; k++) {
        out[k] = v[k] + q[3] * cross[k] + (q[(k + 1) % 3] * cross[(k + 2) % 3] - q[(k + 2) % 3] * cross[(k + 1) % 3]) +
                 t->translation[k];
    }
}

void test_skin_posed(const fixture *f) {
    uint32_t count = 0, v;
    const float *bind = bind_positions(f, &count);
    anthronet_transform *pose = (anthronet_transform *)room(f->joints * sizeof *pose);
    anthronet_joint *joints = (anthronet_joint *)room(f->joints * sizeof *joints);
    float *linear = (float *)room(12 * (size_t)count), *dual = (float *)room(12 * (size_t)count);
    anthronet_skin_job jobs[2];
    anthronet_view slots, weights;
    double worst = 0, far = 0;
    int i, k;
    OK(anthronet_clip_sample(f->walk, NULL, 0.3, ANTHRONET_WRAP_LOOP, ANTHRONET_RELATIVE_TO_MODEL, ANTHRONET_SPACE_GLTF, pose,
                             f->joints, &fault));
    OK(anthronet_body_joints(f->body, ANTHRONET_SPACE_GLTF, joints, f->joints, &fault));
    OK(anthronet_mesh_data(f->mesh, 0, ANTHRONET_ATTRIBUTE_JOINTS, &slots, &fault));
    OK(anthronet_mesh_data(f->mesh, 0, ANTHRONET_ATTRIBUTE_WEIGHTS, &weights, &fault));
    /* Two surfaces in one call. */
    jobs[0] = job_of(f, pose, linear, 12 * (uint64_t)count);
    jobs[1] = job_of(f, pose, dual, 12 * (uint64_t)count);
    jobs[1].method = ANTHRONET_SKIN_DUAL_QUATERNION;
    OK(anthronet_skin(NULL, jobs, 2, &fault));
    for (v = 0; v < count; v++) {
        double sum[3] = {0, 0, 0};
        for (i = 0; i < 4; i++) {
            uint32_t j = ((const uint16_t *)slots.data)[4 * v + (uint32_t)i];
            double w = ((const float *)weights.data)[4 * v + (uint32_t)i], local[3], moved[3];
            const float *m = joints[j].joint_from_model, *p = bind + 3 * (size_t)v;
            for (k = 0; k < 3; k++) local[k] = (double)m[k] * p[0] + (double)m[4 + k] * p[1] + (double)m[8 + k] * p[2] + m[12 + k];
            move(&pose[j], local, moved);
            for (k = 0; k < 3; k++) sum[k] += w * moved[k];
        }
        for (k = 0; k < 3; k++) {
            worst = fmax(worst, fabs(sum[k] - linear[3 * v + (uint32_t)k]));
            far = fmax(far, fabs((double)bind[3 * v + (uint32_t)k] - linear[3 * v + (uint32_t)k]));
        }
    }
    CHECK(worst < 1e-5, "linear skinning is off by %g m", worst);
    CHECK(far > 0.3, "nobody walks who moves by %g m at most", far);
    worst = largest_difference(linear, dual, 3 * (uint64_t)count);
    CHECK(worst > 1e-4 && worst < 0.05, "dual quaternions differ from matrices by %g m", worst);
    free(pose);
    free(joints);
    free(linear);
    free(dual);
}

/* A context keeps memory from call to call, whatever it was used for before, and changes no number. */
void test_context(const fixture *f) {
    uint32_t count = 0, round;
    const size_t bytes = f->joints * sizeof(anthronet_transform);
    anthronet_transform *plain = (anthronet_transform *)room(bytes), *pose = (anthronet_transform *)room(bytes);
    anthronet_context *context = NULL;
    float *expected, *posed;
    (void)bind_positions(f, &count);
    expected = (float *)room(12 * (size_t)count);
    posed = (float *)room(24 * (size_t)count);
    OK(anthronet_context_new(&context, &fault));
    for (round = 0; round < 6; round++) {
        anthronet_skin_job jobs[2];
        const double seconds = 0.1 * round;
        OK(anthronet_clip_sample(f->walk, NULL, seconds, 1, 1, 0, plain, f->joints, &fault));
        OK(anthronet_clip_sample(f->walk, context, seconds, 1, 1, 0, pose, f->joints, &fault));
        CHECK(memcmp(plain, pose, bytes) == 0, "another pose in round %u", round);
        jobs[0] = job_of(f, plain, expected, 12 * (uint64_t)count);
        jobs[0].method = round % 3;
        OK(anthronet_skin(NULL, jobs, 1, &fault));
        jobs[0].positions = posed;
        jobs[1] = jobs[0];
        jobs[1].positions = posed + 3 * (size_t)count;
        OK(anthronet_skin(context, jobs, 1 + round % 2, &fault));
        CHECK(memcmp(expected, posed, 12 * (size_t)count) == 0, "another surface in round %u", round);
        if (round % 2 == 1) CHECK(memcmp(posed, jobs[1].positions, 12 * (size_t)count) == 0, "another second surface");
        /* What is refused leaves it fit for use. */
        jobs[0].joint_count = 1;
        CHECK(anthronet_skin(context, jobs, 1, &fault) == ANTHRONET_ERROR_SIZE, "a pose of one joint");
    }
    anthronet_context_free(context);
    free(plain);
    free(pose);
    free(expected);
    free(posed);
}

/* Offsets, normals, strides, and one buffer for both as vertex buffers are laid out. */
void test_skin_buffers(const fixture *f) {
    anthronet_transform *pose = rest_pose(f, f->body, ANTHRONET_SPACE_GLTF);
    uint32_t count = 0, v;
    const float *bind = bind_positions(f, &count);
    anthronet_view normals;
    float *offsets = (float *)room(12 * (size_t)count), *both = (float *)room(32 * (size_t)count);
    anthronet_skin_job job = job_of(f, pose, both, 32 * (uint64_t)count);
    int k;
    OK(anthronet_mesh_data(f->mesh, 0, ANTHRONET_ATTRIBUTE_NORMALS, &normals, &fault));
    for (v = 0; v < 3 * count; v++) offsets[v] = v % 3 == 1 ? 0.25f : 0.0f;
    job.offsets = offsets;
    job.offset_count = count;
    job.position_stride = 32;
    job.normals = both + 3;
    job.normal_bytes = 32 * (uint64_t)count - 12;
    job.normal_stride = 32;
    fill(both, 32 * (size_t)count);
    OK(anthronet_skin(NULL, &job, 1, &fault));
    for (v = 0; v < count; v++) {
        const float *row = both + 8 * (size_t)v, *n = (const float *)normals.data + 3 * (size_t)v;
        for (k = 0; k < 3; k++) {
            if (!CHECK(fabsf(row[k] - bind[3 * v + (uint32_t)k] - (k == 1 ? 0.25f : 0)) < 1e-5f, "offset of vertex %u", v) ||
                !CHECK(fabsf(row[3 + k] - n[k]) < 1e-4f, "normal of vertex %u", v)) {
                v = count - 1;
                break;
            }
        }
        if (!CHECK(is_filled(row + 6, 8), "what is between the rows is written over, vertex %u", v)) break;
    }
    /* The normal may come first. */
    job.positions = both + 3;
    job.normals = both;
    job.position_bytes = job.normal_bytes;
    OK(anthronet_skin(NULL, &job, 1, &fault));
    CHECK(fabsf(both[3] - bind[0]) < 1e-5f && fabsf(both[0] - ((const float *)normals.data)[0]) < 1e-4f, "normals first");
    /* None at all. */
    OK(anthronet_skin(NULL, NULL, 0, &fault));
    free(pose);
    free(offsets);
    free(both);
}
