//! Static poses: files with joints in other programs, against the .obj of the same person and pose.

use anyhow::Result;

use super::Fixture;
use super::generate;
use super::tally::Tally;
use crate::requests::PEOPLE;

/// Names of people, their poses and the extension of the file.
const FILES: [(&str, &str, &str); 4] = [
    ("readme", "sitting", "glb"),
    ("heavy_man", "standing", "glb"),
    ("heavy_man", "sitting", "usdc"),
    ("thin_tall_woman", "walk@0.4", "usda"),
];

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    for (name, pose, extension) in FILES {
        let person =
            PEOPLE.iter().find(|person| person.name == name).map_or(&[][..], |person| person.arguments);
        let name = format!("{name}_{}", pose.split('@').next().unwrap_or(pose));
        let title = format!("Blender and USD, pose_{name}.{extension}");
        let mut command =
            match environment.blender.clone().and_then(|()| environment.python_script("pose_check.py")) {
                Ok(command) => command,
                Err(reason) => {
                    tally.skip(&title, &reason);
                    continue;
                }
            };
        let posed = [person, &["--pose", pose]].concat();
        let [file, reference, plain] = [
            format!("pose_{name}.{extension}"),
            format!("pose_{name}.obj"),
            format!("pose_{name}_plain.obj"),
        ]
        .map(|file| folder.join(file));
        let made = generate(anthronet, &posed, &file, None)
            .and_then(|()| generate(anthronet, &posed, &reference, None))
            .and_then(|()| generate(anthronet, person, &plain, None));
        if let Err(why) = made {
            tally.case(&format!("generate pose_{name}"), Err(why));
            continue;
        }
        let picture = folder.join(format!("pose_{name}.png"));
        tally.script(&title, command.arg(&file).arg(&reference).arg(&plain).arg(picture));
    }
    Ok(())
}
