//! The nearest measure of a published standard or survey, where there is one.
//!
//! ISO 8559-1:2017 (garment sizing), ISO 7250-1:2017 (technological design) and ANSUR II (Gordon et al. 2014).
//! "Nearest" is not "same": ours are read in a T-pose and between vertices.

/// Names for a measure, with or without its side.
pub(super) fn standard(name: &str) -> Option<&'static str> {
    let name = name.trim_end_matches("_left").trim_end_matches("_right");
    Some(match name {
        "waist_circumference" => "ISO 8559-1 waist girth; ANSUR II waistcircumference",
        "chest_circumference" => "ISO 8559-1 bust/chest girth; ANSUR II chestcircumference",
        "hip_circumference" => "ISO 8559-1 hip girth; ANSUR II buttockcircumference",
        "height" => "ISO 7250-1 stature; ANSUR II stature",
        "shoulder_width" => "ISO 7250-1 shoulder (biacromial) breadth; ANSUR II biacromialbreadth",
        "torso_height_back" => "ISO 8559-1 back neck point to waist; ANSUR II waistbacklength",
        "torso_height_front" => "ANSUR II waistfrontlengthsitting",
        "head_circumference" => "ISO 8559-1 head girth; ANSUR II headcircumference",
        "neck_circumference" => "ISO 8559-1 neck girth; ANSUR II neckcircumference",
        "head_height" => "ISO 8559-1 head height",
        "neck_length_lateral" => "ANSUR II earheight less neckheight, near",
        "hand_size" => "ISO 7250-1 hand length; ANSUR II handlength",
        "arm_circumference" => "ISO 8559-1 upper-arm girth; ANSUR II bicepscircumferenceflexed",
        "arm_length" => "ISO 8559-1 upper-arm length; ANSUR II acromionradialelength",
        "forearm_circumference" => "ANSUR II forearmcircumferenceflexed",
        "forearm_length" => "ANSUR II radialestylionlength",
        "thigh_circumference" => "ISO 8559-1 thigh girth; ANSUR II thighcircumference",
        "calf_circumference" => "ISO 8559-1 calf girth; ANSUR II calfcircumference",
        "calf_length" => "ISO 7250-1 tibial height, near",
        "foot_width" => "ISO 7250-1 foot breadth; ANSUR II footbreadthhorizontal",
        "heel_to_ball_length" => "ANSUR II balloffootlength",
        "heel_to_toe_length" => "ISO 7250-1 foot length; ANSUR II footlength",
        _ => return None,
    })
}
