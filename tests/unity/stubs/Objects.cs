// Stand-ins for Unity's objects and components: as much of them as the package and its tests use. See ../SIGNATURES.md.
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    [Flags]
    public enum HideFlags
    {
        None = 0,
        HideAndDontSave = 61,
    }

    public class Object
    {
        bool destroyed;

        /// For the tests: how many meshes, materials, avatars and objects are alive.
        public static int Alive;

        public Object()
        {
            Alive++;
        }

        public string name { get; set; }
        public HideFlags hideFlags { get; set; }

        public static bool operator ==(Object a, Object b)
        {
            var noA = ReferenceEquals(a, null) || a.destroyed;
            var noB = ReferenceEquals(b, null) || b.destroyed;
            return noA || noB ? noA && noB : ReferenceEquals(a, b);
        }

        public static bool operator !=(Object a, Object b) { return !(a == b); }
        public override bool Equals(object other) { return this == (other as Object); }
        public override int GetHashCode() { return System.Runtime.CompilerServices.RuntimeHelpers.GetHashCode(this); }

        public static void Destroy(Object obj)
        {
            if (obj == null)
            {
                return;
            }
            var home = obj as GameObject;
            if (!ReferenceEquals(home, null))
            {
                if (home.transform.parent != null)
                {
                    home.transform.parent.children.Remove(home.transform);
                }
                foreach (var child in new List<Transform>(home.transform.children))
                {
                    Destroy(child.gameObject);
                }
                foreach (var part in home.parts)
                {
                    MonoBehaviour.Tell(part, "OnDestroy");
                    part.destroyed = true;
                    Alive--;
                }
            }
            obj.destroyed = true;
            Alive--;
        }

        public static void DestroyImmediate(Object obj) { Destroy(obj); }
        public static void DontDestroyOnLoad(Object target) { }
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }
        public Transform transform { get { return gameObject.transform; } }
        public new string name { get { return gameObject.name; } set { gameObject.name = value; } }
        public T GetComponent<T>() { return gameObject.GetComponent<T>(); }
    }

    public class Behaviour : Component
    {
        public bool enabled { get; set; }
    }

    public class MonoBehaviour : Behaviour
    {
        /// For the tests: calls what Unity calls.
        public static void Tell(Component part, string message)
        {
            var method = part.GetType().GetMethod(
                message, BindingFlags.Instance | BindingFlags.NonPublic | BindingFlags.Public, null, Type.EmptyTypes, null);
            if (method != null)
            {
                method.Invoke(part, null);
            }
        }
    }

    public class Transform : Component
    {
        internal readonly List<Transform> children = new List<Transform>();

        public Transform parent { get; private set; }
        public Vector3 localPosition { get; set; }
        public Quaternion localRotation { get; set; }

        public void SetParent(Transform parent, bool worldPositionStays)
        {
            if (this.parent != null)
            {
                this.parent.children.Remove(this);
            }
            this.parent = parent;
            if (parent != null)
            {
                parent.children.Add(this);
            }
        }

        public int childCount { get { return children.Count; } }
        public Transform GetChild(int index) { return children[index]; }

        public Matrix4x4 localToWorldMatrix
        {
            get
            {
                var local = Matrix4x4.TRS(localPosition, localRotation, Vector3.one);
                return parent == null ? local : parent.localToWorldMatrix * local;
            }
        }
    }

    public sealed class GameObject : Object
    {
        internal readonly List<Component> parts = new List<Component>();
        readonly List<Component> asleep = new List<Component>();

        public GameObject(string name)
        {
            this.name = name;
            activeSelf = true;
            transform = AddComponent<Transform>();
            transform.localRotation = Quaternion.identity;
        }

        public Transform transform { get; private set; }
        public bool activeSelf { get; private set; }

        public T AddComponent<T>() where T : Component
        {
            var part = Activator.CreateInstance<T>();
            part.gameObject = this;
            parts.Add(part);
            if (activeSelf)
            {
                MonoBehaviour.Tell(part, "Awake");
            }
            else
            {
                asleep.Add(part);
            }
            return part;
        }

        public T GetComponent<T>()
        {
            foreach (var part in parts)
            {
                if (part is T)
                {
                    return (T)(object)part;
                }
            }
            return default(T);
        }

        public void SetActive(bool value)
        {
            activeSelf = value;
            if (value)
            {
                foreach (var part in asleep)
                {
                    MonoBehaviour.Tell(part, "Awake");
                }
                asleep.Clear();
            }
        }
    }

    public class Renderer : Component
    {
        public Material[] sharedMaterials { get; set; }
    }

    public class SkinnedMeshRenderer : Renderer
    {
        public Mesh sharedMesh { get; set; }
        public Transform[] bones { get; set; }
        public Transform rootBone { get; set; }
        public Bounds localBounds { get; set; }
    }

    public struct LOD
    {
        public float screenRelativeTransitionHeight;
        public Renderer[] renderers;

        public LOD(float screenRelativeTransitionHeight, Renderer[] renderers)
        {
            this.screenRelativeTransitionHeight = screenRelativeTransitionHeight;
            this.renderers = renderers;
        }
    }

    public class LODGroup : Component
    {
        LOD[] lods;
        public void SetLODs(LOD[] lods)
        {
            for (var i = 1; i < lods.Length; i++)
            {
                if (lods[i].screenRelativeTransitionHeight >= lods[i - 1].screenRelativeTransitionHeight)
                {
                    throw new ArgumentException("SetLODs: heights have to fall");
                }
            }
            this.lods = lods;
        }

        public LOD[] GetLODs() { return lods; }
        public void RecalculateBounds() { }
    }

    public sealed class Shader : Object
    {
        /// For the tests: shaders that are in the build.
        public static readonly HashSet<string> Known =
            new HashSet<string> { "Standard", "Universal Render Pipeline/Lit", "HDRP/Lit" };

        public static Shader Find(string name) { return Known.Contains(name) ? new Shader { name = name } : null; }
    }

    public class Material : Object
    {
        public readonly Dictionary<string, object> Values = new Dictionary<string, object>();

        public Material(Shader shader) { this.shader = shader; }
        public Shader shader { get; set; }
        public bool enableInstancing { get; set; }
        public void SetColor(string name, Color value) { Values[name] = value; }
        public void SetFloat(string name, float value) { Values[name] = value; }
        public void EnableKeyword(string keyword) { Values[keyword] = true; }
    }

    public class Animator : Behaviour
    {
        public Avatar avatar { get; set; }
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
        public static string[] BoneName
        {
            get
            {
                return new[]
                {
                    "Hips", "LeftUpperLeg", "RightUpperLeg", "LeftLowerLeg", "RightLowerLeg", "LeftFoot", "RightFoot",
                    "Spine", "Chest", "UpperChest", "Neck", "Head", "LeftShoulder", "RightShoulder", "LeftUpperArm",
                    "RightUpperArm", "LeftLowerArm", "RightLowerArm", "LeftHand", "RightHand", "LeftToes", "RightToes",
                    "LeftEye", "RightEye", "Jaw",
                    "Left Thumb Proximal", "Left Thumb Intermediate", "Left Thumb Distal",
                    "Left Index Proximal", "Left Index Intermediate", "Left Index Distal",
                    "Left Middle Proximal", "Left Middle Intermediate", "Left Middle Distal",
                    "Left Ring Proximal", "Left Ring Intermediate", "Left Ring Distal",
                    "Left Little Proximal", "Left Little Intermediate", "Left Little Distal",
                    "Right Thumb Proximal", "Right Thumb Intermediate", "Right Thumb Distal",
                    "Right Index Proximal", "Right Index Intermediate", "Right Index Distal",
                    "Right Middle Proximal", "Right Middle Intermediate", "Right Middle Distal",
                    "Right Ring Proximal", "Right Ring Intermediate", "Right Ring Distal",
                    "Right Little Proximal", "Right Little Intermediate", "Right Little Distal",
                };
            }
        }

        /// Those that Unity requires.
        public static readonly HashSet<string> Required = new HashSet<string>
        {
            "Hips", "LeftUpperLeg", "RightUpperLeg", "LeftLowerLeg", "RightLowerLeg", "LeftFoot", "RightFoot", "Spine",
            "Head", "LeftUpperArm", "RightUpperArm", "LeftLowerArm", "RightLowerArm", "LeftHand", "RightHand",
        };
    }

    public class AvatarBuilder
    {
        /// Valid where Unity's documented demands are met: all names in the hierarchy, none twice, required bones there.
        public static Avatar BuildHumanAvatar(GameObject go, HumanDescription humanDescription)
        {
            var names = new Dictionary<string, int>();
            Count(go.transform, names);
            var valid = true;
            foreach (var bone in humanDescription.skeleton)
            {
                int times;
                valid &= names.TryGetValue(bone.name, out times) && times == 1;
            }
            var mapped = new HashSet<string>();
            var traits = new HashSet<string>(HumanTrait.BoneName);
            foreach (var bone in humanDescription.human)
            {
                valid &= traits.Contains(bone.humanName) && mapped.Add(bone.humanName) && names.ContainsKey(bone.boneName);
            }
            return new Avatar(valid && HumanTrait.Required.IsSubsetOf(mapped));
        }

        static void Count(Transform at, Dictionary<string, int> names)
        {
            int times;
            names.TryGetValue(at.name, out times);
            names[at.name] = times + 1;
            for (var i = 0; i < at.childCount; i++)
            {
                Count(at.GetChild(i), names);
            }
        }
    }

    public static class Debug
    {
        /// For the tests: what was complained of.
        public static readonly List<string> Errors = new List<string>();
        public static void Log(object message) { }
        public static void LogError(object message) { Errors.Add(message.ToString()); }
        public static void LogError(object message, Object context) { Errors.Add(message.ToString()); }
        public static void LogException(Exception exception) { Errors.Add(exception.ToString()); }
    }

    public static class Application
    {
        public static bool isPlaying { get { return true; } }
    }

    public static class Time
    {
        public static float deltaTime { get; set; }
    }

    public enum RuntimeInitializeLoadType
    {
        SubsystemRegistration = 4,
    }

    [AttributeUsage(AttributeTargets.Method)]
    public class RuntimeInitializeOnLoadMethodAttribute : Attribute
    {
        public RuntimeInitializeOnLoadMethodAttribute(RuntimeInitializeLoadType loadType) { }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class SerializeField : Attribute { }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class HideInInspector : Attribute { }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class RangeAttribute : Attribute
    {
        public RangeAttribute(float min, float max) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class AddComponentMenu : Attribute
    {
        public AddComponentMenu(string menuName) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class DisallowMultipleComponent : Attribute { }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class RequireComponent : Attribute
    {
        public RequireComponent(Type requiredComponent) { }
    }
}

namespace UnityEngine.Rendering
{
    public enum CullMode
    {
        Off = 0,
        Front = 1,
        Back = 2,
    }

    public abstract class RenderPipelineAsset : Object { }

    public static class GraphicsSettings
    {
        public static RenderPipelineAsset currentRenderPipeline { get; set; }
    }
}
