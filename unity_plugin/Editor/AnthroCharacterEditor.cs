using System;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>The inspector of a character: measures in groups, each with its switch; generate, randomise, the report.
    /// </summary>
    [CustomEditor(typeof(AnthroCharacter))]
    public sealed class AnthroCharacterEditor : UnityEditor.Editor
    {
        struct Group
        {
            public string title;
            public int first;
            public int count;
        }

        // In the order of the measures: those of the middle, then the same twelve of each side.
        static readonly Group[] groups =
        {
            new Group { title = "Body", first = 0, count = 12 },
            new Group { title = "Left side", first = 12, count = 12 },
            new Group { title = "Right side", first = 24, count = 12 },
        };

        static readonly string[] settings =
        {
            "finestLod", "coarsestLod", "skinTone", "bodyOnly", "humanoid", "generateOnAwake", "materials",
        };

        static readonly bool[] open = { true, false, false };

        readonly AnthroMeasureReport[] reports = new AnthroMeasureReport[AnthroMeasures.Count];
        bool reported;

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            var character = (AnthroCharacter)target;
            var request = serializedObject.FindProperty("request");
            EditorGUILayout.PropertyField(request.FindPropertyRelative("sex"));
            EditorGUILayout.PropertyField(request.FindPropertyRelative("seed"));
            EditorGUILayout.PropertyField(request.FindPropertyRelative("fill"));
            EditorGUILayout.PropertyField(request.FindPropertyRelative("nearest"));
            reported = character.Body != null;
            if (reported)
            {
                character.Body.Measures(reports);
            }
            var metres = request.FindPropertyRelative("metres");
            var given = request.FindPropertyRelative("given");
            for (var i = 0; i < groups.Length; i++)
            {
                open[i] = EditorGUILayout.Foldout(open[i], groups[i].title, true);
                for (var k = 0; open[i] && k < groups[i].count; k++)
                {
                    var measure = groups[i].first + k;
                    Measure(measure, metres.GetArrayElementAtIndex(measure), given.GetArrayElementAtIndex(measure));
                }
            }
            foreach (var setting in settings)
            {
                EditorGUILayout.PropertyField(serializedObject.FindProperty(setting), true);
            }
            serializedObject.ApplyModifiedProperties();
            if (GUILayout.Button("Generate"))
            {
                Generate(character);
            }
            if (GUILayout.Button("Randomise"))
            {
                Undo.RecordObject(character, "Randomise");
                character.Request.Seed = unchecked((ulong)Guid.NewGuid().GetHashCode()) & 0x7fffffff;
                character.Request.Fill = AnthroFill.Sample;
                Generate(character);
            }
            if (reported)
            {
                EditorGUILayout.HelpBox(Summary(character.Body), MessageType.Info);
            }
        }

        void Measure(int measure, SerializedProperty metres, SerializedProperty given)
        {
            double min, max;
            AnthroModel.Default.Range(measure, out min, out max);
            EditorGUILayout.BeginHorizontal();
            var now = EditorGUILayout.ToggleLeft(Label(measure), given.boolValue);
            if (now && !given.boolValue)
            {
                // A measure that is switched on begins with what the body has.
                metres.doubleValue = reported ? reports[measure].obtained : 0.5 * (min + max);
            }
            given.boolValue = now;
            if (now)
            {
                metres.doubleValue = EditorGUILayout.Slider((float)metres.doubleValue, (float)min, (float)max);
            }
            else if (reported)
            {
                EditorGUILayout.LabelField(reports[measure].obtained.ToString("0.000") + " m");
            }
            if (reported)
            {
                EditorGUILayout.LabelField(now
                    ? (1000 * reports[measure].residual).ToString("+0.0;-0.0;0.0") + " mm"
                    : reports[measure].percentile.ToString("0") + " %");
            }
            EditorGUILayout.EndHorizontal();
        }

        static string Label(int measure)
        {
            var name = AnthroMeasures.Names[measure].Replace("_left", "").Replace("_right", "").Replace('_', ' ');
            return char.ToUpperInvariant(name[0]) + name.Substring(1);
        }

        static string Summary(AnthroBody body)
        {
            return body.Sex + ", " + body.Mass.ToString("0.0") + " kg, BMI " + body.Bmi.ToString("0.0") + ", largest residual "
                + (1000 * body.SolveResidual).ToString("0.00") + " mm, warnings: " + body.WarningCount;
        }

        static void Generate(AnthroCharacter character)
        {
            try
            {
                character.Generate();
            }
            catch (AnthroException error)
            {
                EditorUtility.DisplayDialog("AnthroNet", error.Message, "OK");
            }
        }
    }
}
