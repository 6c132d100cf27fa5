// Stand-ins for Unity's immediate-mode GUI: controls return the value that they get, or the answer of `User`. See
// ../signatures.txt.
using System;

namespace UnityEngine
{
    public class GUILayoutOption { }

    /// Simulated input.
    static class User
    {
        /// From a control's label and value to its new value; null leaves the value.
        internal static Func<string, object, object> Answer = null;
        internal static bool Changed;

        internal static T Ask<T>(string label, T value)
        {
            var answer = Answer == null ? null : Answer(label, value);
            if (answer == null || answer.Equals(value))
            {
                return value;
            }
            Changed = true;
            return (T)answer;
        }
    }

    public class GUILayout
    {
        public static bool Button(string text, params GUILayoutOption[] options) { return User.Ask(text, false); }
        public static void Label(string text, params GUILayoutOption[] options) { }
        public static bool Toggle(bool value, string text, params GUILayoutOption[] options) { return User.Ask(text, value); }
        public static float HorizontalSlider(float value, float leftValue, float rightValue, params GUILayoutOption[] options)
        {
            return User.Ask("slider", value);
        }
        public static GUILayoutOption Width(float width) { return new GUILayoutOption(); }
        public static void BeginHorizontal(params GUILayoutOption[] options) { }
        public static void EndHorizontal() { }
        public static Vector2 BeginScrollView(Vector2 scrollPosition, params GUILayoutOption[] options) { return scrollPosition; }
        public static void EndScrollView() { }
        public static void BeginArea(Rect screenRect) { }
        public static void EndArea() { }
    }

    public sealed class Screen
    {
        public static int height { get { return 720; } }
    }
}
