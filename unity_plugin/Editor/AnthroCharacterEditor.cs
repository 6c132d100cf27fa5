using System;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>Inspector of a character: request with report, Generate, Randomise, Save as prefab.</summary>
    [CustomEditor(typeof(AnthroCharacter))]
    public sealed class AnthroCharacterEditor : UnityEditor.Editor
    {
        static readonly string[] settings =
        {
            "finestLod", "coarsestLod", "skinTone", "bodyOnly", "humanoid", "generateOnAwake", "materials",
        };

        readonly AnthroRequestGui gui = new AnthroRequestGui();
        SerializedObject asset;

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            var character = (AnthroCharacter)target;
            if (!AnthroRequestGui.DrawWithLibrary(() => Draw(character)))
            {
                EditorGUILayout.PropertyField(serializedObject.FindProperty("generateOnAwake"), true);
                serializedObject.ApplyModifiedProperties();
            }
        }

        void Draw(AnthroCharacter character)
        {
            serializedObject.Update();
            EditorGUILayout.PropertyField(serializedObject.FindProperty("requestAsset"), true);
            var body = character.Body;
            if (character.RequestAsset != null)
            {
                if (asset == null || asset.targetObject != character.RequestAsset)
                {
                    asset = new SerializedObject(character.RequestAsset);
                }
                asset.Update();
                gui.Draw(asset.FindProperty("request"), body);
                asset.ApplyModifiedProperties();
            }
            else
            {
                gui.Draw(serializedObject.FindProperty("request"), body);
            }
            foreach (var setting in settings)
            {
                EditorGUILayout.PropertyField(serializedObject.FindProperty(setting), true);
            }
            serializedObject.ApplyModifiedProperties();
            if (character.IsBaked)
            {
                EditorGUILayout.HelpBox("Baked: meshes and avatar are assets. Generate replaces them by generated ones.", MessageType.Info);
            }
            if (GUILayout.Button("Generate"))
            {
                Generate(character, "Generate");
            }
            if (GUILayout.Button("Randomise"))
            {
                Randomise(character);
            }
            if (body != null && GUILayout.Button("Save as prefab…"))
            {
                var path = EditorUtility.SaveFilePanelInProject(
                    "Save character", character.name, "prefab", "The prefab; request, meshes, avatar and materials go into an asset beside it.");
                if (!string.IsNullOrEmpty(path))
                {
                    ShowErrors(() => AnthroSave.SavePrefab(character, path));
                }
            }
            if (character.Body != null)
            {
                EditorGUILayout.HelpBox(Summary(character.Body), MessageType.Info);
            }
        }

        /// <summary>Generates another person with the same requested measures. One undo step.</summary>
        internal static void Randomise(AnthroCharacter character)
        {
            var holder = character.RequestAsset != null ? (UnityEngine.Object)character.RequestAsset : character;
            Undo.RecordObject(holder, "Randomise");
            character.Request.Seed = unchecked((ulong)Guid.NewGuid().GetHashCode()) & 0x7fffffff;
            character.Request.Fill = AnthroFill.Sample;
            EditorUtility.SetDirty(holder);
            Generate(character, "Randomise");
        }

        /// <summary>Generates the character and marks the scene as changed; errors are shown in a dialog.</summary>
        internal static void Generate(AnthroCharacter character, string step)
        {
            Undo.RecordObject(character, step);
            ShowErrors(character.Generate);
            EditorUtility.SetDirty(character);
            PrefabUtility.RecordPrefabInstancePropertyModifications(character);
        }

        static void ShowErrors(Action action)
        {
            try
            {
                action();
            }
            catch (Exception error) when (error is AnthroException || error is InvalidOperationException
                || error is System.IO.IOException)
            {
                EditorUtility.DisplayDialog("AnthroNet", error.Message, "OK");
            }
        }

        static string Summary(AnthroBody body)
        {
            return body.Sex + ", " + body.Mass.ToString("0.0") + " kg, BMI " + body.Bmi.ToString("0.0") + ", largest residual "
                + (1000 * body.SolveResidual).ToString("0.00") + " mm, warnings: " + body.WarningCount;
        }
    }
}
