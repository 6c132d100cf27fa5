using System;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>Draws a request: sex, seed and filling, then the measures in groups, each with a toggle, a slider and the
    /// value of the body.</summary>
    internal sealed class AnthroRequestGui
    {
        struct Group
        {
            public string title;
            public int first, count;
        }

        static readonly Group[] apart =
        {
            new Group { title = "Body", first = 0, count = AnthroMeasures.Central },
            new Group { title = "Left side", first = AnthroMeasures.Central, count = AnthroMeasures.PerSide },
            new Group { title = "Right side", first = AnthroMeasures.Central + AnthroMeasures.PerSide, count = AnthroMeasures.PerSide },
        };

        static readonly Group[] linked =
        {
            new Group { title = "Body", first = 0, count = AnthroMeasures.Central },
            new Group { title = "Both sides", first = AnthroMeasures.Central, count = AnthroMeasures.PerSide },
        };

        static readonly string[] fields = { "sex", "seed", "fill", "nearest" };

        // Shared by all inspectors until the next domain reload.
        static readonly bool[] open = { true, false, false };
        internal static bool Linked = true;

        readonly AnthroMeasureReport[] reports = new AnthroMeasureReport[AnthroMeasures.Count];
        readonly double[] min = new double[AnthroMeasures.Count];
        readonly double[] max = new double[AnthroMeasures.Count];
        bool ranges;
        bool reported;

        /// <summary>Draws an inspector that needs the native library. Where the library is missing or of another release,
        /// the error is shown in the inspector: it would be thrown again at every repaint and fill the console.</summary>
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

        /// <summary>Draws the serialised property of a request, with the values of a body; null for none.</summary>
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
            Linked = EditorGUILayout.ToggleLeft("Link left and right", Linked);
            var metres = request.FindPropertyRelative("metres");
            var given = request.FindPropertyRelative("given");
            var groups = Linked ? linked : apart;
            for (var i = 0; i < groups.Length; i++)
            {
                open[i] = EditorGUILayout.Foldout(open[i], groups[i].title, true);
                for (var k = 0; open[i] && k < groups[i].count; k++)
                {
                    var measure = groups[i].first + k;
                    var other = Linked && i == 1 ? measure + AnthroMeasures.PerSide : measure;
                    Measure(measure, other, metres, given);
                }
            }
        }

        void ReadRanges()
        {
            for (var i = 0; !ranges && i < AnthroMeasures.Count; i++)
            {
                AnthroModel.Default.MeasureRange(i, out min[i], out max[i]);
            }
            ranges = true;
        }

        /// <summary>Draws the row of a measure and of its counterpart on the other side, which may be the same.</summary>
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
                // The slider has less precision than the value: write the value only if the user moved the slider.
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
                EditorGUILayout.LabelField(ReportText(reports[measure], now));
            }
            EditorGUILayout.EndHorizontal();
        }

        void Switch(int measure, bool on, SerializedProperty metres, SerializedProperty given)
        {
            given.GetArrayElementAtIndex(measure).boolValue = on;
            if (on)
            {
                // Start with the value of the body.
                metres.GetArrayElementAtIndex(measure).doubleValue =
                    reported ? reports[measure].obtained : 0.5 * (min[measure] + max[measure]);
            }
        }

        /// <summary>The report of a measure: the residual of a requested one, the value and the 90 % interval of any
        /// other one, and the percentile.</summary>
        internal static string ReportText(AnthroMeasureReport report, bool given)
        {
            var percentile = ", percentile " + report.percentile.ToString("0");
            if (given)
            {
                return "residual " + (1000 * report.residual).ToString("+0.0;-0.0;0.0") + " mm" + percentile;
            }
            return report.obtained.ToString("0.000") + " m (90 %: " + report.low90.ToString("0.000") + " to "
                + report.high90.ToString("0.000") + ")" + percentile;
        }

        /// <summary>The label of a measure, with its unit.</summary>
        internal static string Label(int measure)
        {
            var name = AnthroMeasures.Names[measure].Replace("_left", "").Replace("_right", "").Replace('_', ' ');
            return char.ToUpperInvariant(name[0]) + name.Substring(1) + " (m)";
        }
    }
}
