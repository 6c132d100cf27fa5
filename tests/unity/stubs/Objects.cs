// Stand-ins for Unity's objects and components and their life cycle, as far as package and tests use them. Public members
// have Unity's signatures, see ../signatures.txt; internal ones are for the tests.
using System;
using System.Collections;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    [Flags]
    public enum HideFlags
    {
        None = 0,
        HideInHierarchy = 1,
        DontSave = 52,
        HideAndDontSave = 61,
    }

    public class Object
    {
        static int last;
        readonly int id = ++last;
        internal bool Destroyed;
        /// Part of a prefab instance, which Unity does not allow to destroy.
        internal bool OfPrefab;
        /// A project asset: destroying it without permission is an error in Unity.
        internal bool Asset;

        /// Number of live objects, components, meshes, materials and avatars.
        internal static int Alive;

        public Object()
        {
            Alive++;
        }

        public virtual string name { get; set; }
        public HideFlags hideFlags { get; set; }
        public int GetInstanceID() { return id; }

        public static bool operator ==(Object x, Object y)
        {
            var noX = ReferenceEquals(x, null) || x.Destroyed;
            var noY = ReferenceEquals(y, null) || y.Destroyed;
            return noX || noY ? noX && noY : ReferenceEquals(x, y);
        }

        public static bool operator !=(Object x, Object y) { return !(x == y); }
        public override bool Equals(object other) { return this == (other as Object); }
        public override int GetHashCode() { return id; }

        public static void Destroy(Object obj)
        {
            if (!Application.isPlaying)
            {
                throw new InvalidOperationException("Destroy may not be called from edit mode! Use DestroyImmediate instead.");
            }
            End(obj);
        }

        public static void DestroyImmediate(Object obj)
        {
            if (obj != null && obj.OfPrefab)
            {
                throw new InvalidOperationException("Destroying a GameObject inside a Prefab instance is not allowed.");
            }
            End(obj);
        }

        static void End(Object obj)
        {
            if (obj == null)
            {
                return;
            }
            if (obj.Asset)
            {
                throw new InvalidOperationException("Destroying assets is not permitted to avoid data loss: " + obj.name);
            }
            var home = obj as GameObject;
            if (!ReferenceEquals(home, null))
            {
                home.EndAll();
            }
            obj.Destroyed = true;
            Alive--;
        }

        public static void DontDestroyOnLoad(Object target) { }

        public static T Instantiate<T>(T original) where T : Object
        {
            var home = original as GameObject;
            return (T)(Object)Cloning.Of(home);
        }
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }
        public Transform transform { get { return gameObject.transform; } }
        public override string name { get { return gameObject.name; } set { gameObject.name = value; } }
        public T GetComponent<T>() { return gameObject.GetComponent<T>(); }
    }

    public class Behaviour : Component
    {
        bool on = true;
        public bool enabled { get { return on; } set { on = value; } }
        public bool isActiveAndEnabled { get { return on && gameObject.activeInHierarchy; } }
    }

    public class MonoBehaviour : Behaviour
    {
        internal bool Awoken, Enabled;

        /// Sends a Unity message.
        internal static void Send(Component part, string message)
        {
            var method = part.GetType().GetMethod(
                message, BindingFlags.Instance | BindingFlags.NonPublic | BindingFlags.Public, null, Type.EmptyTypes, null);
            if (method == null)
            {
                return;
            }
            try
            {
                method.Invoke(part, null);
            }
            catch (TargetInvocationException error)
            {
                throw error.InnerException;
            }
        }

        /// In edit mode Unity sends messages only to scripts that ask for it.
        bool Hears()
        {
            return Application.isPlaying || Attribute.IsDefined(GetType(), typeof(ExecuteAlways));
        }

        internal void WakeUp()
        {
            if (!Hears())
            {
                return;
            }
            if (!Awoken)
            {
                Awoken = true;
                Send(this, "Awake");
            }
            if (!Enabled && enabled)
            {
                Enabled = true;
                Send(this, "OnEnable");
            }
        }

        internal void FallAsleep()
        {
            if (Enabled)
            {
                Enabled = false;
                Send(this, "OnDisable");
            }
        }

        /// Unity sends OnDestroy only to scripts that were awake once.
        internal void Die()
        {
            FallAsleep();
            if (Awoken)
            {
                Send(this, "OnDestroy");
            }
        }
    }

    public class ScriptableObject : Object
    {
        public static T CreateInstance<T>() where T : ScriptableObject { return Activator.CreateInstance<T>(); }
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
        public Transform Find(string n) { return children.Find(child => child.name == n); }

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

        public GameObject(string name)
        {
            this.name = name;
            activeSelf = true;
            transform = AddComponent<Transform>();
            transform.localRotation = Quaternion.identity;
        }

        public Transform transform { get; private set; }
        public bool activeSelf { get; private set; }

        public bool activeInHierarchy
        {
            get { return activeSelf && (transform.parent == null || transform.parent.gameObject.activeInHierarchy); }
        }

        public T AddComponent<T>() where T : Component
        {
            return (T)Add(typeof(T));
        }

        internal Component Add(Type type)
        {
            if (Attribute.IsDefined(type, typeof(DisallowMultipleComponent)) && parts.Exists(type.IsInstanceOfType))
            {
                Debug.LogError("Can't add " + type.Name + " twice");
                return null;
            }
            foreach (RequireComponent needed in type.GetCustomAttributes(typeof(RequireComponent), true))
            {
                if (!parts.Exists(needed.Type.IsInstanceOfType))
                {
                    Add(needed.Type);
                }
            }
            var part = (Component)Activator.CreateInstance(type);
            part.gameObject = this;
            parts.Add(part);
            var script = part as MonoBehaviour;
            if (script != null && activeInHierarchy)
            {
                script.WakeUp();
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
            if (value != activeSelf)
            {
                activeSelf = value;
                Scripts(script =>
                {
                    if (value && script.gameObject.activeInHierarchy)
                    {
                        script.WakeUp();
                    }
                    else if (!value)
                    {
                        script.FallAsleep();
                    }
                });
            }
        }

        /// All scripts of the object and its children.
        internal void Scripts(Action<MonoBehaviour> action)
        {
            foreach (var part in new List<Component>(parts))
            {
                var script = part as MonoBehaviour;
                if (!ReferenceEquals(script, null))
                {
                    action(script);
                }
            }
            foreach (var child in new List<Transform>(transform.children))
            {
                child.gameObject.Scripts(action);
            }
        }

        internal void EndAll()
        {
            if (transform.parent != null)
            {
                transform.parent.children.Remove(transform);
            }
            EndBelow();
        }

        void EndBelow()
        {
            foreach (var part in new List<Component>(parts))
            {
                var script = part as MonoBehaviour;
                if (!ReferenceEquals(script, null))
                {
                    script.Die();
                }
            }
            foreach (var child in new List<Transform>(transform.children))
            {
                child.gameObject.EndBelow();
                child.gameObject.Destroyed = true;
                Alive--;
            }
            transform.children.Clear();
            foreach (var part in parts)
            {
                part.Destroyed = true;
                Alive--;
            }
        }
    }

    /// Instantiate: copies the fields that Unity serialises.
    static class Cloning
    {
        const BindingFlags Own = BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic;

        internal static IEnumerable<FieldInfo> Fields(Type type)
        {
            foreach (var field in type.GetFields(Own))
            {
                if (field.IsPublic || Attribute.IsDefined(field, typeof(SerializeField)))
                {
                    yield return field;
                }
            }
        }

        internal static GameObject Of(GameObject original)
        {
            var map = new Dictionary<Object, Object>();
            var copy = Shape(original, map);
            Fill(original, map);
            copy.Scripts(script =>
            {
                if (script.gameObject.activeInHierarchy)
                {
                    script.WakeUp();
                }
            });
            return copy;
        }

        static GameObject Shape(GameObject from, Dictionary<Object, Object> map)
        {
            var copy = new GameObject(from.name + (map.Count == 0 ? "(Clone)" : ""));
            var active = from.activeSelf;
            copy.SetActive(false);
            map[from] = copy;
            foreach (var part in from.parts)
            {
                var other = part is Transform ? copy.transform : copy.Add(part.GetType());
                map[part] = other;
            }
            copy.transform.localPosition = from.transform.localPosition;
            copy.transform.localRotation = from.transform.localRotation;
            foreach (var child in from.transform.children)
            {
                Shape(child.gameObject, map).transform.SetParent(copy.transform, false);
            }
            typeof(GameObject).GetProperty("activeSelf").GetSetMethod(true).Invoke(copy, new object[] { active });
            return copy;
        }

        static void Fill(GameObject from, Dictionary<Object, Object> map)
        {
            foreach (var part in from.parts)
            {
                if (part is MonoBehaviour)
                {
                    foreach (var field in Fields(part.GetType()))
                    {
                        field.SetValue(map[part], Copy(field.GetValue(part), map));
                    }
                }
                var drawn = part as SkinnedMeshRenderer;
                if (!ReferenceEquals(drawn, null))
                {
                    var other = (SkinnedMeshRenderer)map[part];
                    other.enabled = drawn.enabled;
                    other.sharedMesh = drawn.sharedMesh;
                    other.sharedMaterials = drawn.sharedMaterials;
                    other.bones = (Transform[])Copy(drawn.bones, map);
                    other.rootBone = (Transform)Copy(drawn.rootBone, map);
                }
            }
            foreach (var child in from.transform.children)
            {
                Fill(child.gameObject, map);
            }
        }

        static object Copy(object value, Dictionary<Object, Object> map)
        {
            var one = value as Object;
            if (!ReferenceEquals(one, null))
            {
                Object other;
                return map.TryGetValue(one, out other) ? other : one;
            }
            var list = value as IList;
            if (list != null)
            {
                var array = value as Array;
                var copy = (IList)(array != null ? array.Clone() : Activator.CreateInstance(value.GetType()));
                for (var i = 0; i < list.Count; i++)
                {
                    var item = Copy(list[i], map);
                    if (array != null)
                    {
                        copy[i] = item;
                    }
                    else
                    {
                        copy.Add(item);
                    }
                }
                return copy;
            }
            if (value == null || value.GetType().IsValueType || value is string)
            {
                return value;
            }
            var made = Activator.CreateInstance(value.GetType());
            foreach (var field in Fields(value.GetType()))
            {
                field.SetValue(made, Copy(field.GetValue(value), map));
            }
            return made;
        }
    }

    public static class Debug
    {
        /// Logged errors.
        internal static readonly List<string> Errors = new List<string>();
        public static void Log(object message) { }
        public static void LogError(object message) { Errors.Add(message.ToString()); }
        public static void LogError(object message, Object context) { Errors.Add(message.ToString()); }
        public static void LogException(Exception exception) { Errors.Add(exception.ToString()); }
        public static void LogException(Exception exception, Object context) { Errors.Add(exception.ToString()); }
        /// Logged warnings.
        internal static readonly List<string> Warnings = new List<string>();
        public static void LogWarning(object message) { Warnings.Add(message.ToString()); }
    }

    public static class Application
    {
        internal static bool Playing = true;
        public static bool isPlaying { get { return Playing; } }
    }

    public static class Time
    {
        public static float deltaTime { get { return 1f / 60; } }
    }

    public class TextAsset : Object
    {
        public TextAsset(string text) { this.text = text; }
        public string text { get; private set; }
    }
}
