# Godot 3 has imported figure.glb: skeleton, meshes, clips, and where joints are in a frame of each, as expected.json says.
#
#     godot3-server --path FOLDER --script check.gd

extends SceneTree

# Metres. Godot bakes 30 keys a second of whatever rate a clip has, and goes straight between them.
const TOLERANCE = 1e-3

var failed = 0


func case(name, good, why = ""):
	if good:
		print("ok Godot: ", name)
	else:
		failed += 1
		print("FAILED Godot: ", name, ": ", why)


func find_all(node, kind, found):
	if node.is_class(kind):
		found.append(node)
	for child in node.get_children():
		find_all(child, kind, found)
	return found


# Plays the clip up to a time, in a scene of its own, and compares where joints are.
func places(packed, clip):
	var scene = packed.instance()
	var skeleton = find_all(scene, "Skeleton", [])[0]
	var player = find_all(scene, "AnimationPlayer", [])[0]
	player.play(clip.name)
	player.seek(clip.time, true)
	var above = Transform()
	var node = skeleton
	while node != scene.get_parent():
		above = node.transform * above
		node = node.get_parent()
	# Godot 3 takes capitals and leading zeros out of the names of bones.
	var expected = {}
	for name in clip.places:
		expected[name.to_lower().replace("_0", "_")] = clip.places[name]
	var worst = 0.0
	var at = "none"
	var found = 0
	for bone in range(skeleton.get_bone_count()):
		var name = skeleton.get_bone_name(bone)
		if not expected.has(name):
			continue
		found += 1
		var place = expected[name]
		var goal = Vector3(place[0], place[1], place[2])
		var off = (above.xform(skeleton.get_bone_global_pose(bone).origin) - goal).length()
		if not off <= worst:
			worst = off
			at = name
	case("%s: all %d joints have their names" % [clip.name, clip.places.size()], found == clip.places.size(), str(found))
	case("%s: joints at %.3f s (largest difference %.4f mm)" % [clip.name, clip.time, worst * 1000], worst <= TOLERANCE,
		"%s is %f mm off" % [at, worst * 1000])
	scene.free()


func _init():
	var file = File.new()
	file.open("res://expected.json", File.READ)
	var expected = JSON.parse(file.get_as_text()).result
	file.close()
	var packed = load("res://figure.glb")
	case("imports the file", packed != null, "not imported")
	if packed == null:
		quit(1)
		return
	var scene = packed.instance()
	var skeletons = find_all(scene, "Skeleton", [])
	case("one skeleton", skeletons.size() == 1, str(skeletons.size()))
	if skeletons.size() == 1:
		var bones = skeletons[0].get_bone_count()
		case("%d bones" % bones, bones == int(expected.joints), "expected %d" % expected.joints)
	var meshes = find_all(scene, "MeshInstance", [])
	case("%d meshes" % meshes.size(), meshes.size() == int(expected.meshes), "expected %d" % expected.meshes)
	var skinned = 0
	for mesh in meshes:
		if mesh.skin != null:
			skinned += 1
	case("all meshes have a skin", skinned == meshes.size(), "%d of %d" % [skinned, meshes.size()])
	var players = find_all(scene, "AnimationPlayer", [])
	case("one animation player", players.size() == 1, str(players.size()))
	if players.size() == 1:
		for clip in expected.clips:
			var found = players[0].has_animation(clip.name)
			case("has the clip %s" % clip.name, found, str(players[0].get_animation_list()))
			if not found:
				continue
			var animation = players[0].get_animation(clip.name)
			var length = animation.length
			case("%s lasts %.4f s" % [clip.name, length], abs(length - clip.length) < 1e-3, "expected %f" % clip.length)
			var tracks = animation.get_track_count()
			case("%s has %d tracks" % [clip.name, tracks], tracks == int(clip.tracks), "expected %d" % clip.tracks)
			places(packed, clip)
	scene.free()
	quit(1 if failed > 0 else 0)
