//! Wrong arguments end with exit code 2 and a message that names the option or the measure, without a file.

mod common;

use common::{anthronet, files_in, folder, generate};

#[test]
fn values_that_are_no_length_are_bad_usage() {
    for value in ["NaN", "inf", "-inf", "-1.7", "0", "", "tall", "1,70", "1.7.0", "5ft13in", "1e999", "170kg"]
    {
        generate(&["-m", &format!("height={value}")]).fails(2, &["height"]);
    }
    generate(&["-m", "height"]).fails(2, &["NAME=VALUE"]);
    generate(&["-m", "=1.7"]).fails(2, &["name"]);
    generate(&["-m", "height=1.7", "-m", "height=1.8"]).fails(2, &["height", "twice"]);
}

#[test]
fn an_unknown_name_gets_a_suggestion() {
    generate(&["-m", "heigth=1.7"]).fails(2, &["heigth", "did you mean", "height"]);
    generate(&["-m", "waist=0.8"]).fails(2, &["waist", "waist_circumference"]);
    generate(&["-m", "stature=1.7"]).fails(2, &["stature", "height"]);
    generate(&["-m", "weight=70"]).fails(2, &["weight", "cannot be set"]);
}

#[test]
fn options_that_do_not_exist_are_bad_usage() {
    generate(&["--sex", "other"]).fails(2, &["--sex", "female", "male"]);
    generate(&["--lod", "4"]).fails(2, &["--lod"]);
    generate(&["--influences", "5"]).fails(2, &["--influences", "4", "8"]);
    generate(&["--joint-names", "maya"]).fails(2, &["--joint-names", "native", "mixamo"]);
    generate(&["--skin-tone", "11"]).fails(2, &["--skin-tone", "11"]);
    generate(&["--skin-tone", "#12345"]).fails(2, &["--skin-tone"]);
    generate(&["--seed", "-1"]).fails(2, &["--seed"]);
    generate(&["--z", "1,two"]).fails(2, &["--z", "two"]);
    generate(&["--fill", "zero"]).fails(2, &["--fill", "mean", "sample"]);
    generate(&["--at", "0.5"]).fails(2, &["--interpolate"]);
    generate(&["--interpolate", "other.json"]).fails(2, &["--at"]);
    generate(&["--interpolate", "other.json", "--at", "1.5"]).fails(2, &["--at", "0 to 1"]);
    generate(&["--no-such-option"]).fails(2, &["--no-such-option"]);
}

#[test]
fn the_output_is_required_and_its_extension_known() {
    anthronet(&["generate", "-m", "height=1.7"], &[]).fails(2, &["--output"]);
    anthronet(&["preview", "a.glb"], &[]).fails(2, &["--output"]);
    anthronet(&["contact-sheet"], &[]).fails(2, &["--output"]);
    let folder = folder();
    for name in ["a.stl", "a", "a.glb.txt", "glb"] {
        let path = folder.path().join(name);
        let path = path.to_string_lossy();
        anthronet(&["generate", "-o", &path], &[])
            .fails(2, &[name, ".glb .gltf .vrm .vrma .usda .usdc .usdz .obj"]);
        anthronet(&["contact-sheet", "-o", &path], &[]).fails(2, &[name, ".png"]);
    }
    assert!(files_in(folder.path()).is_empty());
    anthronet(&["measure", "a.fbx"], &[]).fails(2, &["a.fbx", ".glb .gltf .vrm .usda .usdc .usdz .obj"]);
    anthronet(&["preview", "a.fbx", "-o", "a.png"], &[]).fails(2, &["a.fbx", ".json"]);
    anthronet(&["preview", "a.glb", "-o", "a.png", "--size", "0x4"], &[]).fails(2, &["--size", "0x4"]);
    anthronet(&["preview", "a.glb", "-o", "a.png", "--views", "below"], &[]).fails(2, &["--views", "front"]);
    anthronet(&["contact-sheet", "-o", "a.png", "--count", "0"], &[]).fails(2, &["--count"]);
    anthronet(&[], &[]).fails(2, &["Usage"]);
    anthronet(&["no-such-command"], &[]).fails(2, &["no-such-command"]);
}

#[test]
fn a_millimetre_value_without_its_unit_gets_a_hint() {
    generate(&["-m", "height=1700"]).fails(2, &["height", "did you mean 1.7"]);
    generate(&["-m", "height=170"]).fails(2, &["height", "did you mean 1.7"]);
    generate(&["-m", "height=0.3"]).fails(2, &["height"]);
}
