// Stand-ins for Unity's inspectors: serialised objects by reflection, and editor controls. See ../signatures.txt.
using System;
using System.Collections;
using System.Collections.Generic;
using System.Reflection;
using UnityEngine;
using Object = UnityEngine.Object;

namespace UnityEditor
{
    public enum MessageType
    {
        None = 0,
        Info = 1,
        Warning = 2,
        Error = 3,
    }

    /// Writes straight to the object; `Written` counts the writes that would mark it as changed.
    public class SerializedObject
    {
        internal int Written;

        public SerializedObject(Object obj) { targetObject = obj; }
        public Object targetObject { get; private set; }
        public void Update() { }

        public bool ApplyModifiedProperties()
        {
            return Written > 0;
        }

        public SerializedProperty FindProperty(string propertyPath)
        {
            return SerializedProperty.Of(this, targetObject, propertyPath);
        }
    }

    public class SerializedProperty
    {
        SerializedObject root;
        Func<object> get;
        Action<object> set;

        internal static SerializedProperty Of(SerializedObject root, object holder, string name)
        {
            var field = holder.GetType().GetField(name, BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic);
            if (field == null || !(field.IsPublic || Attribute.IsDefined(field, typeof(SerializeField))))
            {
                return null;
            }
            return new SerializedProperty
            {
                root = root, get = () => field.GetValue(holder), set = value => field.SetValue(holder, value), name = name,
            };
        }

        public string name { get; private set; }
        public SerializedProperty FindPropertyRelative(string relativePropertyPath) { return Of(root, get(), relativePropertyPath); }

        public SerializedProperty GetArrayElementAtIndex(int index)
        {
            var list = (IList)get();
            return new SerializedProperty
            {
                root = root, get = () => list[index], set = value => list[index] = value, name = name + "[" + index + "]",
            };
        }

        void Write(object value)
        {
            root.Written++;
            set(value);
        }

        public bool boolValue { get { return (bool)get(); } set { Write(value); } }
        public double doubleValue { get { return (double)get(); } set { Write(value); } }
        internal object Value { get { return get(); } }
    }

    public class Editor : ScriptableObject
    {
        public Object target { get; set; }
        SerializedObject seen;
        public SerializedObject serializedObject { get { return seen ?? (seen = new SerializedObject(target)); } }
        public virtual void OnInspectorGUI() { }
    }

    public sealed class EditorGUI
    {
        static readonly Stack<bool> before = new Stack<bool>();

        public static void BeginChangeCheck()
        {
            before.Push(User.Changed);
            User.Changed = false;
        }

        public static bool EndChangeCheck()
        {
            var changed = User.Changed;
            User.Changed = before.Pop() || changed;
            return changed;
        }
    }

    public sealed class EditorGUILayout
    {
        /// Texts shown.
        internal static readonly List<string> Shown = new List<string>();

        static bool Field(SerializedProperty property)
        {
            if (property == null)
            {
                throw new NullReferenceException("a field of a property that there is not");
            }
            Shown.Add(property.name);
            return false;
        }

        public static bool PropertyField(SerializedProperty property, params GUILayoutOption[] options) { return Field(property); }
        public static bool PropertyField(SerializedProperty property, bool includeChildren, params GUILayoutOption[] options) { return Field(property); }
        public static bool Foldout(bool foldout, string content, bool toggleOnLabelClick) { Shown.Add(content); return User.Ask(content, foldout); }
        public static bool ToggleLeft(string label, bool value, params GUILayoutOption[] options) { Shown.Add(label); return User.Ask(label, value); }
        public static float Slider(float value, float leftValue, float rightValue, params GUILayoutOption[] options)
        {
            return Math.Max(leftValue, Math.Min(rightValue, User.Ask("slider", value)));
        }
        public static void LabelField(string label, params GUILayoutOption[] options) { Shown.Add(label); }
        public static void HelpBox(string message, MessageType type) { Shown.Add(message); }
        public static Rect BeginHorizontal(params GUILayoutOption[] options) { return new Rect(); }
        public static void EndHorizontal() { }
    }
}
