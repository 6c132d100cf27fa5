// Stand-ins for Unity's animation: animators, avatars, clips. See ../signatures.txt.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public class RuntimeAnimatorController : Object { }

    public enum AnimatorControllerParameterType
    {
        Float = 1,
        Int = 3,
        Bool = 4,
        Trigger = 9,
    }

    public class AnimatorControllerParameter
    {
        public string name { get; set; }
        public AnimatorControllerParameterType type { get; set; }
        public int nameHash { get { return Animator.StringToHash(name); } }
    }

    public struct AnimatorStateInfo
    {
        internal int Hash;
        internal float Time;
        public int fullPathHash { get { return Hash; } }
        public float normalizedTime { get { return Time; } }
    }

    /// One state per layer; setting an avatar resets it, as in Unity.
    public class Animator : Behaviour
    {
        Avatar worn;
        internal readonly Dictionary<int, float> Values = new Dictionary<int, float>();
        internal AnimatorStateInfo[] States = new AnimatorStateInfo[0];
        internal AnimatorControllerParameter[] Has = new AnimatorControllerParameter[0];

        public RuntimeAnimatorController runtimeAnimatorController { get; set; }

        public Avatar avatar
        {
            get { return worn; }
            set
            {
                worn = value;
                Values.Clear();
                Array.Clear(States, 0, States.Length);
            }
        }

        public int layerCount { get { return States.Length; } }
        public AnimatorControllerParameter[] parameters { get { return (AnimatorControllerParameter[])Has.Clone(); } }
        public AnimatorStateInfo GetCurrentAnimatorStateInfo(int layerIndex) { return States[layerIndex]; }

        public void Play(int stateNameHash, int layer, float normalizedTime)
        {
            States[layer] = new AnimatorStateInfo { Hash = stateNameHash, Time = normalizedTime };
        }

        public static int StringToHash(string name) { return name.GetHashCode(); }
        public float GetFloat(int id) { return Value(id); }
        public int GetInteger(int id) { return (int)Value(id); }
        public bool GetBool(int id) { return Value(id) != 0; }
        public void SetFloat(int id, float value) { Values[id] = value; }
        public void SetInteger(int id, int value) { Values[id] = value; }
        public void SetBool(int id, bool value) { Values[id] = value ? 1 : 0; }

        float Value(int id)
        {
            float value;
            Values.TryGetValue(id, out value);
            return value;
        }
    }

    public struct Keyframe
    {
        public Keyframe(float time, float value, float inTangent, float outTangent)
            : this()
        {
            this.time = time;
            this.value = value;
            this.inTangent = inTangent;
            this.outTangent = outTangent;
        }

        public float time { get; set; }
        public float value { get; set; }
        public float inTangent { get; set; }
        public float outTangent { get; set; }
    }

    public class AnimationCurve
    {
        readonly Keyframe[] all;

        public AnimationCurve(params Keyframe[] keys)
        {
            for (var i = 1; i < keys.Length; i++)
            {
                if (!(keys[i - 1].time < keys[i].time))
                {
                    throw new ArgumentException("AnimationCurve: times have to rise");
                }
            }
            all = (Keyframe[])keys.Clone();
        }

        public Keyframe[] keys { get { return (Keyframe[])all.Clone(); } }

        /// Cubic interpolation between two keys.
        public float Evaluate(float time)
        {
            if (time <= all[0].time)
            {
                return all[0].value;
            }
            var next = Array.FindIndex(all, key => key.time > time);
            if (next < 0)
            {
                return all[all.Length - 1].value;
            }
            Keyframe a = all[next - 1], b = all[next];
            float span = b.time - a.time, t = (time - a.time) / span, u = 1 - t;
            return (1 + 2 * t) * u * u * a.value + t * u * u * span * a.outTangent
                + t * t * (3 - 2 * t) * b.value - t * t * u * span * b.inTangent;
        }
    }

    public sealed class AnimationClip : Object
    {
        internal readonly Dictionary<string, AnimationCurve> Curves = new Dictionary<string, AnimationCurve>();
        internal bool Continuous, Loops;

        public bool legacy { get; set; }
        public float frameRate { get; set; }

        public void SetCurve(string relativePath, Type type, string propertyName, AnimationCurve curve)
        {
            if (!legacy)
            {
                throw new InvalidOperationException("Can't use AnimationClip::SetCurve at Runtime on non Legacy AnimationClip.");
            }
            Set(relativePath, type, propertyName, curve);
        }

        internal void Set(string path, Type type, string property, AnimationCurve curve)
        {
            if (type != typeof(Transform) || Curves.ContainsKey(path + ":" + property))
            {
                throw new ArgumentException("a curve of another type, or twice: " + path + ":" + property);
            }
            Curves[path + ":" + property] = curve;
        }

        public void EnsureQuaternionContinuity() { Continuous = true; }
    }

    public class Avatar : Object
    {
        internal Avatar(bool valid) { isValid = isHuman = valid; }
        public bool isValid { get; private set; }
        public bool isHuman { get; private set; }
    }

    public struct HumanLimit
    {
        public bool useDefaultValues { get; set; }
    }

    public struct HumanBone
    {
        public HumanLimit limit;
        public string boneName { get; set; }
        public string humanName { get; set; }
    }

    public struct SkeletonBone
    {
        public string name;
        public Vector3 position;
        public Quaternion rotation;
        public Vector3 scale;
    }

    public struct HumanDescription
    {
        public HumanBone[] human;
        public SkeletonBone[] skeleton;
        public float upperArmTwist { get; set; }
        public float lowerArmTwist { get; set; }
        public float upperLegTwist { get; set; }
        public float lowerLegTwist { get; set; }
        public float armStretch { get; set; }
        public float legStretch { get; set; }
        public float feetSpacing { get; set; }
        public bool hasTranslationDoF { get; set; }
    }

    public class HumanTrait
    {
        // Name, whether it is required, and the parent bone.
        static readonly string[] table =
        {
            "Hips *", "LeftUpperLeg * Hips", "RightUpperLeg * Hips", "LeftLowerLeg * LeftUpperLeg",
            "RightLowerLeg * RightUpperLeg", "LeftFoot * LeftLowerLeg", "RightFoot * RightLowerLeg", "Spine * Hips",
            "Chest Spine", "UpperChest Chest", "Neck UpperChest", "Head * Neck", "LeftShoulder UpperChest",
            "RightShoulder UpperChest", "LeftUpperArm * LeftShoulder", "RightUpperArm * RightShoulder",
            "LeftLowerArm * LeftUpperArm", "RightLowerArm * RightUpperArm", "LeftHand * LeftLowerArm",
            "RightHand * RightLowerArm", "LeftToes LeftFoot", "RightToes RightFoot", "LeftEye Head", "RightEye Head",
            "Jaw Head",
        };

        static readonly List<string> names = new List<string>(), parents = new List<string>();
        static readonly List<bool> required = new List<bool>();

        static HumanTrait()
        {
            foreach (var row in table)
            {
                var words = row.Split(' ');
                var needed = words.Length > 1 && words[1] == "*";
                names.Add(words[0]);
                required.Add(needed);
                parents.Add(words[words.Length - 1] == "*" ? null : words[words.Length - 1]);
            }
            foreach (var side in new[] { "Left", "Right" })
            {
                foreach (var finger in new[] { "Thumb", "Index", "Middle", "Ring", "Little" })
                {
                    var parent = side + "Hand";
                    foreach (var part in new[] { "Proximal", "Intermediate", "Distal" })
                    {
                        names.Add(side + " " + finger + " " + part);
                        required.Add(false);
                        parents.Add(parent);
                        parent = names[names.Count - 1];
                    }
                }
            }
        }

        public static int BoneCount { get { return names.Count; } }
        public static string[] BoneName { get { return names.ToArray(); } }
        public static bool RequiredBone(int i) { return required[i]; }
        public static int GetParentBone(int i) { return names.IndexOf(parents[i]); }
    }

    public class AvatarBuilder
    {
        /// Why the last avatar is invalid; null if it is valid.
        internal static string Why;

        /// Valid if Unity's documented requirements are met: all names in the hierarchy and unique, required bones
        /// present, human parents above their bones, no UpperChest without Chest, a T-pose.
        public static Avatar BuildHumanAvatar(GameObject go, HumanDescription humanDescription)
        {
            Why = Wrong(go, humanDescription);
            return new Avatar(Why == null);
        }

        static string Wrong(GameObject go, HumanDescription description)
        {
            var there = new Dictionary<string, Transform>();
            string twice = null;
            Walk(go.transform, at =>
            {
                twice = there.ContainsKey(at.name) ? at.name : twice;
                there[at.name] = at;
            });
            foreach (var bone in description.skeleton)
            {
                if (!there.ContainsKey(bone.name))
                {
                    return "no transform is called " + bone.name;
                }
                if (bone.name == twice)
                {
                    return "two transforms are called " + twice;
                }
            }
            var mapped = new Dictionary<string, Transform>();
            var traits = new List<string>(HumanTrait.BoneName);
            foreach (var bone in description.human)
            {
                if (!traits.Contains(bone.humanName) || mapped.ContainsKey(bone.humanName) || !there.ContainsKey(bone.boneName))
                {
                    return bone.humanName + ": no bone of a human, twice, or not there";
                }
                mapped[bone.humanName] = there[bone.boneName];
            }
            for (var i = 0; i < traits.Count; i++)
            {
                if (HumanTrait.RequiredBone(i) && !mapped.ContainsKey(traits[i]))
                {
                    return traits[i] + " is required";
                }
                var above = Parent(i, mapped);
                if (mapped.ContainsKey(traits[i]) && above != null && !Above(above, mapped[traits[i]]))
                {
                    return traits[i] + " is not below " + above.name;
                }
            }
            if (mapped.ContainsKey("UpperChest") && !mapped.ContainsKey("Chest"))
            {
                return "UpperChest without Chest";
            }
            return Arms(mapped);
        }

        /// The closest mapped human bone above.
        static Transform Parent(int bone, Dictionary<string, Transform> mapped)
        {
            for (var i = HumanTrait.GetParentBone(bone); i >= 0; i = HumanTrait.GetParentBone(i))
            {
                Transform found;
                if (mapped.TryGetValue(HumanTrait.BoneName[i], out found))
                {
                    return found;
                }
            }
            return null;
        }

        static bool Above(Transform above, Transform below)
        {
            for (var at = below.parent; at != null; at = at.parent)
            {
                if (ReferenceEquals(at, above))
                {
                    return true;
                }
            }
            return false;
        }

        /// In a T-pose arms are horizontal, here within a degree.
        static string Arms(Dictionary<string, Transform> mapped)
        {
            foreach (var side in new[] { "Left", "Right" })
            {
                var names = new[] { side + "UpperArm", side + "LowerArm", side + "Hand" };
                for (var i = 0; i < 2; i++)
                {
                    Matrix4x4 from = mapped[names[i]].localToWorldMatrix, to = mapped[names[i + 1]].localToWorldMatrix;
                    var way = new Vector3(to.m03 - from.m03, to.m13 - from.m13, to.m23 - from.m23);
                    if (Math.Abs(way.y) > Math.Sin(Math.PI / 180) * way.magnitude)
                    {
                        return names[i] + " is not level: " + way;
                    }
                }
            }
            return null;
        }

        static void Walk(Transform at, Action<Transform> visit)
        {
            visit(at);
            foreach (var child in at.children)
            {
                Walk(child, visit);
            }
        }
    }
}
