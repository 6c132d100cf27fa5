/* Every function of the library with what it has to return: built as C99 and as C++17, and linked both ways. */

#include "values.h"

int main(int argc, char **argv) {
    static const test TESTS[] = {
        {"versions", test_version},
        {"models from everywhere make the same body", test_model_open},
        {"a model describes itself", test_model_describes},
        {"measures by place and name", test_measures},
        {"requests keep what is set", test_request},
        {"bodies have the asked measures to 0.1 mm", test_generate},
        {"latent numbers make the body again", test_latent},
        {"bodies between two requests", test_interpolate},
        {"the log callback hears warnings", test_log},
        {"meshes of every level, layout and space", test_meshes},
        {"mesh options", test_mesh_options},
        {"rows with a stride", test_mesh_read},
        {"a mesh made another body's", test_mesh_update},
        {"blend shapes lead to another body", test_blend_shapes},
        {"joints of every space", test_joints},
        {"humanoid bones", test_humanoid},
        {"skinned at rest nothing moves", test_skin_at_rest},
        {"skinned as the formula says", test_skin_posed},
        {"a context changes no number", test_context},
        {"skinned into every kind of buffer", test_skin_buffers},
        {"built-in clips", test_builtin_clips},
        {"samples and baked frames", test_sample},
        {"clips made of clips", test_clips_made_of_clips},
        {"a clip of poses", test_clip_of_poses},
        {"motion files", test_motion_files},
        {"a motion of poses", test_motion_of_poses},
        {"exports to memory", test_export_memory},
        {"exports to files, measured again", test_export_path},
        {"a job", test_job},
        {"a job cancelled", test_job_cancelled},
    };
    return run_tests(argc, argv, TESTS, LENGTH(TESTS));
}
