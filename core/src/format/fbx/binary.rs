//! Converts FBX text to a binary file, for tests: the same nodes in the layout of version 7400 (A. Gessler, "FBX binary
//! file format specification", Blender developers' blog, 2013).

/// A node: name, properties, child nodes.
struct Node {
    name: String,
    properties: Vec<Property>,
    children: Vec<Node>,
}

enum Property {
    Int(i32),
    Long(i64),
    Double(f64),
    Text(String),
    Ints(Vec<i32>),
    Longs(Vec<i64>),
    Floats(Vec<f32>),
}

/// The binary file for a text with one node per line, arrays as `Name: *N {` with `a: …` on the next line, and no commas
/// or braces in strings.
pub(in crate::format) fn binary(text: &str) -> Vec<u8> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with(';'));
    let nodes = nodes(&mut lines);
    let mut out = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    out.extend(7400_u32.to_le_bytes());
    for node in &nodes {
        write(node, &mut out);
    }
    out.extend([0; 13]);
    // The footer: an ID, padding, the version and its magic bytes.
    out.extend([
        0xfa, 0xbc, 0xab, 0x09, 0xd0, 0xc8, 0xd4, 0x66, 0xb1, 0x76, 0xfb, 0x83, 0x1c, 0xf7, 0x26, 0x7e,
    ]);
    out.resize(out.len().next_multiple_of(16) + 4, 0);
    out.extend(7400_u32.to_le_bytes());
    out.extend([0; 120]);
    out.extend([
        0xf8, 0x5a, 0x8c, 0x6a, 0xde, 0xf5, 0xd9, 0x7e, 0xec, 0xe9, 0x0c, 0xe3, 0x75, 0x8f, 0x29, 0x0b,
    ]);
    out
}

fn nodes<'a>(lines: &mut impl Iterator<Item = &'a str>) -> Vec<Node> {
    let mut nodes = Vec::new();
    while let Some(line) = lines.next().filter(|line| *line != "}") {
        let (name, rest) = line.split_once(':').unwrap();
        let open = rest.ends_with('{');
        let rest = rest.trim_end_matches('{').trim();
        if rest.starts_with('*') {
            let values = lines.next().unwrap().trim_start_matches("a:");
            assert_eq!(lines.next(), Some("}"));
            nodes.push(Node { name: name.into(), properties: vec![array(name, values)], children: vec![] });
            continue;
        }
        let mut properties: Vec<Property> = rest.split(',').filter(|p| !p.is_empty()).map(property).collect();
        if name == "P" {
            // Object IDs and times are 64-bit integers; properties of a floating-point type are doubles.
            let double = ["double", "Number", "Vector3D", "Lcl Translation", "Lcl Scaling", "Lcl Rotation"];
            let Property::Text(kind) = &properties[1] else { panic!("{line}") };
            let (double, long) = (double.contains(&kind.as_str()), kind == "KTime");
            for value in &mut properties[4..] {
                if let Property::Int(whole) = *value {
                    *value = match (double, long) {
                        (true, _) => Property::Double(f64::from(whole)),
                        (_, true) => Property::Long(i64::from(whole)),
                        _ => continue,
                    };
                }
            }
        } else if name != "FBXVersion" && name != "KeyVer" {
            for value in &mut properties {
                if let Property::Int(whole) = *value {
                    *value = Property::Long(i64::from(whole));
                }
            }
        }
        let children = if open { self::nodes(lines) } else { vec![] };
        nodes.push(Node { name: name.into(), properties, children });
    }
    nodes
}

fn property(text: &str) -> Property {
    let text = text.trim();
    if let Some(text) = text.strip_prefix('"') {
        let text = text.trim_end_matches('"');
        // In binary files an object's class follows its name.
        let text = text.split_once("::").map_or(text.into(), |(kind, name)| format!("{name}\0\x01{kind}"));
        return Property::Text(text);
    }
    match text.parse::<i64>() {
        Ok(whole) => i32::try_from(whole).map_or(Property::Long(whole), Property::Int),
        Err(_) => Property::Double(text.parse().unwrap()),
    }
}

fn array(name: &str, text: &str) -> Property {
    let numbers = || text.split(',').map(str::trim);
    match name {
        "KeyTime" => Property::Longs(numbers().map(|n| n.parse().unwrap()).collect()),
        "KeyValueFloat" | "KeyAttrDataFloat" => {
            Property::Floats(numbers().map(|n| n.parse().unwrap()).collect())
        }
        _ => Property::Ints(numbers().map(|n| n.parse().unwrap()).collect()),
    }
}

fn write(node: &Node, out: &mut Vec<u8>) {
    let start = out.len();
    // The node's end offset is filled in below.
    out.extend([0; 4]);
    let properties: Vec<u8> = node.properties.iter().flat_map(bytes).collect();
    out.extend((node.properties.len() as u32).to_le_bytes());
    out.extend((properties.len() as u32).to_le_bytes());
    out.push(node.name.len() as u8);
    out.extend(node.name.as_bytes());
    out.extend(properties);
    for child in &node.children {
        write(child, out);
    }
    if !node.children.is_empty() {
        out.extend([0; 13]);
    }
    let end = (out.len() as u32).to_le_bytes();
    out[start..start + 4].copy_from_slice(&end);
}

fn bytes(property: &Property) -> Vec<u8> {
    fn all<T: Copy, const N: usize>(code: u8, values: &[T], bytes: impl Fn(T) -> [u8; N]) -> Vec<u8> {
        let data: Vec<u8> = values.iter().flat_map(|value| bytes(*value)).collect();
        // Array length, encoding (0 = uncompressed), byte length.
        let head = [values.len() as u32, 0, data.len() as u32].map(u32::to_le_bytes).concat();
        [&[code][..], &head, &data].concat()
    }
    match property {
        Property::Int(value) => [&b"I"[..], &value.to_le_bytes()].concat(),
        Property::Long(value) => [&b"L"[..], &value.to_le_bytes()].concat(),
        Property::Double(value) => [&b"D"[..], &value.to_le_bytes()].concat(),
        Property::Text(text) => [&b"S"[..], &(text.len() as u32).to_le_bytes(), text.as_bytes()].concat(),
        Property::Ints(values) => all(b'i', values, i32::to_le_bytes),
        Property::Longs(values) => all(b'l', values, i64::to_le_bytes),
        Property::Floats(values) => all(b'f', values, f32::to_le_bytes),
    }
}
