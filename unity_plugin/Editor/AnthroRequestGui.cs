using System;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>Draws a request: sex, seed and filling, then the measures in groups, each with its switch, its slider, and
    /// what the body has of it.</summary>
    internal sealed class AnthroRequestGui
    {
        struct Group
        {
            public string title;
            public int first;
        }

        /// <summary>Measures of a group: twelve of the middle, and the same twelve of each side.</summary>
        internal const int GroupSize = 12;

        static readonly Group[] apart =
        {
            new Group { title = "Body", first = 0 },
            new Group { title = "Left side", first = GroupSize },
            new Group { title = "Right side", first = 2 * GroupSize },
        };

        static readonly Group[] linked =
        {
            new Group { title = "Body", first = 0 },
            new Group { title = "Both sides", first = GroupSize },
        };

        static readonly string[] fields = { "sex", "seed", "fill", "nearest" };

        // Of all inspectors, as long as the code is loaded.
        static readonly bool[] open = { true, false, false };
        internal static bool Linked = true;

        readonly AnthroMeasureReport[] reports = new AnthroMeasureReport[AnthroMeasures.Count];
        readonly double[] min = new double[AnthroMeasures.Count];
        readonly double[] max = new double[AnthroMeasures.Count];
        bool ranges;
        bool reported;

        /// <summary>Draws an inspector that needs the native library. Where the library is missing or of another release, the
        /// error is shown in the inspector: it would be thrown again at every repaint and fill the console.</summary>
        /// <returns>Whether everything was drawn.</returns>
        public static bool DrawWithLibrary(Action draw)
        {
            try
            {
                draw();
                return true;
            }
            catch (Exception error) when (error is DllNotFoundException || error is NotSupportedException)
            {
                EditorGUILayout.HelpBox(error.Message, MessageType.Error);
                return false;
            }
        }

        /// <summary>Draws the property of a request, and beside it what a body has; null for none.</summary>
        public void Draw(SerializedProperty request, AnthroBody body)
        {
            ReadRanges();
            reported = body != null;
            if (reported)
            {
                body.Measures(reports);
            }
            foreach (var field in fields)
            {
                EditorGUILayout.PropertyField(request.FindPropertyRelative(field));
            }
            Linked = EditorGUILayout.ToggleLeft("Left and right together", Linked);
            var metres = request.FindPropertyRelative("metres");
            var given = request.FindPropertyRelative("given");
            var groups = Linked ? linked : apart;
            for (var i = 0; i < groups.Length; i++)
            {
                open[i] = EditorGUILayout.Foldout(open[i], groups[i].title, true);
                for (var k = 0; open[i] && k < GroupSize; k++)
                {
                    var measure = groups[i].first + k;
                    var other = Linked && i == 1 ? measure + GroupSize : measure;
                    Measure(measure, other, metres, given);
                }
            }
        }

        void ReadRanges()
        {
            for (var i = 0; !ranges && i < AnthroMeasures.Count; i++)
            {
                AnthroModel.Default.Range(i, out min[i], out max[i]);
            }
            ranges = true;
        }

        /// <summary>A row: a measure, and the one of the other side that goes with it or itself.</summary>
        void Measure(int measure, int other, SerializedProperty metres, SerializedProperty given)
        {
            var value = metres.GetArrayElementAtIndex(measure);
            var there = given.GetArrayElementAtIndex(measure);
            EditorGUILayout.BeginHorizontal();
            EditorGUI.BeginChangeCheck();
            var now = EditorGUILayout.ToggleLeft(Label(measure), there.boolValue);
            if (EditorGUI.EndChangeCheck())
            {
                Switch(measure, now, metres, given);
                if (other != measure)
                {
                    Switch(other, now, metres, given);
                }
            }
            if (now)
            {
                // A slider has not all digits of the number: it is written where the user moved it alone.
                EditorGUI.BeginChangeCheck();
                var moved = EditorGUILayout.Slider((float)value.doubleValue, (float)min[measure], (float)max[measure]);
                if (EditorGUI.EndChangeCheck())
                {
                    value.doubleValue = moved;
                    metres.GetArrayElementAtIndex(other).doubleValue = moved;
                }
            }
            if (reported)
            {
                EditorGUILayout.LabelField(Told(reports[measure], now));
            }
            EditorGUILayout.EndHorizontal();
        }

        void Switch(int measure, bool on, SerializedProperty metres, SerializedProperty given)
        {
            given.GetArrayElementAtIndex(measure).boolValue = on;
            if (on)
            {
                // It begins with what the body has.
                metres.GetArrayElementAtIndex(measure).doubleValue =
                    reported ? reports[measure].obtained : 0.5 * (min[measure] + max[measure]);
            }
        }

        /// <summary>What the body has of a measure: of a given one the residual, of an open one the length and what 90 % of
        /// such people have; of both the percentile.</summary>
        internal static string Told(AnthroMeasureReport report, bool given)
        {
            var percentile = ", percentile " + report.percentile.ToString("0");
            if (given)
            {
                return (1000 * report.residual).ToString("+0.0;-0.0;0.0") + " mm" + percentile;
            }
            return report.obtained.ToString("0.000") + " m (90 %: " + report.low90.ToString("0.000") + " to "
                + report.high90.ToString("0.000") + ")" + percentile;
        }

        /// <summary>The name of a measure as it is shown.</summary>
        internal static string Label(int measure)
        {
            var name = AnthroMeasures.Names[measure].Replace("_left", "").Replace("_right", "").Replace('_', ' ');
            return char.ToUpperInvariant(name[0]) + name.Substring(1);
        }
    }
}
