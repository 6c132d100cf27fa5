using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using Anthronet.Editor;
using NUnit.Framework;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Inspectors, menu entries, saving.
    [TestFixture]
    public static class EditorTests
    {
        [SetUp]
        public static void Edit()
        {
            Application.Playing = false;
            EditorGUILayout.Shown.Clear();
            EditorUtility.Dirty.Clear();
            EditorUtility.Dialogs.Clear();
            Undo.Steps.Clear();
            AnthroRequestGui.Linked = true;
        }

        [TearDown]
        public static void Play()
        {
            Application.Playing = true;
            User.Answer = null;
            PrefabUtility.Fails = false;
        }

        static AnthroCharacterEditor Inspector(AnthroCharacter character)
        {
            return new AnthroCharacterEditor { target = character };
        }

        static void Draw(UnityEditor.Editor inspector, Func<string, object, object> does)
        {
            EditorGUILayout.Shown.Clear();
            User.Answer = does;
            inspector.OnInspectorGUI();
            User.Answer = null;
        }

        [Test(Description = "menu: the entry adds a selected character below the context object, with undo")]
        public static void Menu()
        {
            var parent = new GameObject("parent");
            AnthroMenu.Create(new MenuCommand(parent));
            var made = (GameObject)Selection.activeObject;
            Expect.That(made.transform.parent == parent.transform && Undo.Steps.Count == 1, "parent, undo");
            Expect.That(made.GetComponent<AnthroCharacter>().Body != null, "not generated");
            UnityEngine.Object.DestroyImmediate(parent);
        }

        [Test(Description = "inspector: drawing changes nothing; toggles and sliders of both sides, percentiles and intervals")]
        public static void Looking()
        {
            var character = new GameObject("person").AddComponent<AnthroCharacter>();
            character.Request.Set("height", 1.7012345678);
            character.Generate();
            var inspector = Inspector(character);
            Draw(inspector, null);
            Expect.Equal(0, inspector.serializedObject.Written, "properties that are written by looking");
            Expect.Equal(1.7012345678, character.Request[3], "rounded");
            Expect.That(EditorGUILayout.Shown.Any(text => text.Contains(" mm, percentile ")), "the given measure");
            Expect.Equal(11, EditorGUILayout.Shown.Count(text => text.Contains("(90 %: ")), "intervals of the open ones");
            Expect.That(EditorGUILayout.Shown.Any(text => text.Contains("BMI")), "summary");
            var waist = character.Body.Measures()[0].obtained;
            Draw(inspector, (label, value) => label == "Waist circumference (m)" ? (object)true : null);
            Expect.That(character.Request.IsGiven(0), "not given");
            Expect.Equal(waist, character.Request[0], "it begins with what the body has");
            var sliders = 0;
            Draw(inspector, (label, value) => label == "slider" && ++sliders == 1 ? (object)0.9f : null);
            Expect.Near(0.9, character.Request[0], 1e-6, "the slider");
            Expect.Equal(1.7012345678, character.Request[3], "the other one");
            // Both sides at once, or each alone.
            Draw(inspector, (label, value) => label == "Both sides" || label == "Hand size (m)" ? (object)true : null);
            int left = AnthroMeasures.IndexOf("hand_size_left"), right = AnthroMeasures.IndexOf("hand_size_right");
            Expect.That(character.Request.IsGiven(left) && character.Request.IsGiven(right), "both sides");
            Draw(inspector, (label, value) => label == "Link left and right" ? (object)false : null);
            sliders = 0;
            Draw(inspector, (label, value) => label == "slider" && ++sliders == 3 ? (object)0.2f : null);
            Expect.Near(0.2, character.Request[left], 1e-6, "left");
            Expect.That(Math.Abs(character.Request[right] - 0.2) > 1e-3, "the right one went along");
            Scene.Destroy(character);
        }

        [Test(Description = "inspector: Generate and Randomise can be undone, mark the object as changed, and show errors")]
        public static void Buttons()
        {
            var character = new GameObject("person").AddComponent<AnthroCharacter>();
            var inspector = Inspector(character);
            Draw(inspector, (label, value) => label == "Generate" ? (object)true : null);
            Expect.That(Undo.Steps.SequenceEqual(new[] { "Generate" }) && EditorUtility.Dirty.Contains(character), "generate");
            Draw(inspector, (label, value) => label == "Randomise" ? (object)true : null);
            Expect.That(Undo.Steps.Contains("Randomise") && character.Body.Seed != 0, "randomise");
            var body = character.Body;
            character.Request.Set("height", 9);
            Draw(inspector, (label, value) => label == "Generate" ? (object)true : null);
            Expect.That(EditorUtility.Dialogs.Single().Contains("height") && ReferenceEquals(body, character.Body), "refused");
            Scene.Destroy(character);
        }

        [Test(Description = "inspector: with a request asset, the asset's request is shown and changed")]
        public static void OfAsset()
        {
            var asset = ScriptableObject.CreateInstance<AnthroRequestAsset>();
            var character = new GameObject("person").AddComponent<AnthroCharacter>();
            character.RequestAsset = asset;
            Draw(Inspector(character), (label, value) => label == "Height (m)" ? (object)true : null);
            Expect.That(asset.Request.IsGiven(3), "the asset's");
            Draw(Inspector(character), (label, value) => label == "Randomise" ? (object)true : null);
            Expect.That(asset.Request.Seed != 0 && EditorUtility.Dirty.Contains(asset), "randomised");
            Draw(new AnthroRequestAssetEditor { target = asset }, (label, value) => label == "Height (m)" ? (object)false : null);
            Expect.That(!asset.Request.IsGiven(3), "its own inspector");
            Scene.Destroy(character);
            UnityEngine.Object.DestroyImmediate(asset);
        }

        [Test(Description = "saving: a prefab with meshes, avatar and materials as assets outlives its character and is not generated")]
        public static void Prefab()
        {
            var character = new GameObject("person").AddComponent<AnthroCharacter>();
            character.Request.Set("height", 1.66);
            character.Generate();
            var worn = character.GetRenderer(0).sharedMaterials;
            Draw(Inspector(character), (label, value) => label.StartsWith("Save as prefab") ? (object)true
                : label == "Save character" ? "Assets/Person.prefab" : null);
            Expect.Equal("", string.Join(" ", EditorUtility.Dialogs), "complaints");
            var parts = AssetDatabase.Files["Assets/Person.asset"];
            Expect.Near(1.66, ((AnthroRequestAsset)parts[0]).Request[3], 1e-9, "the request");
            Expect.Equal(4, parts.OfType<Mesh>().Count(), "meshes");
            Expect.Equal(1, parts.OfType<Avatar>().Count(), "avatars");
            Expect.Equal(worn.Distinct().Count(), parts.OfType<Material>().Count(), "materials, each once");
            Expect.That(worn.All(material => !AssetDatabase.Contains(material)), "those of all characters are no assets");
            Expect.That(character.IsBaked && !character.GenerateOnAwake && character.Body == null, "not baked");
            Scene.Destroy(character);
            var prefab = PrefabUtility.Prefabs["Assets/Person.prefab"];
            var drawn = prefab.transform.Find("LOD0").GetComponent<SkinnedMeshRenderer>();
            Expect.That(drawn.sharedMesh.Streams[0].Length > 0 && drawn.bones.All(bone => bone != null), "it went with the character");
            // An instance awakes as saved, in play mode too; Generate turns it into a generated character with the same
            // objects.
            Application.Playing = true;
            var instance = UnityEngine.Object.Instantiate(prefab).GetComponent<AnthroCharacter>();
            Expect.That(instance.Body == null && instance.IsBaked, "generated");
            var children = instance.transform.childCount;
            instance.Generate();
            Expect.That(!instance.IsBaked && instance.Body != null && children == instance.transform.childCount, "not generated");
            Expect.That(!AssetDatabase.Contains(instance.GetMesh(0)), "it changed the asset");
            Scene.Destroy(instance);
            Expect.That(parts.All(part => part != null), "assets were destroyed");
            prefab.Scripts(script => script.Awoken = false);
            AssetDatabase.DeleteAsset("Assets/Person.asset");
            UnityEngine.Object.Destroy(prefab);
        }

        [Test(Description = "saving: if Unity cannot save, no asset is left behind and the character is complete")]
        public static void NotSaved()
        {
            var character = new GameObject("person").AddComponent<AnthroCharacter>();
            PrefabUtility.Fails = true;
            Expect.Throws<IOException>(() => AnthroSave.SavePrefab(character, "Assets/Other.prefab"), "it failed");
            Expect.That(!AssetDatabase.Files.ContainsKey("Assets/Other.asset"), "an asset is left");
            Expect.That(!character.IsBaked && character.GenerateOnAwake, "baked");
            Expect.That(character.Body != null && character.GetMesh(0) != null && character.GetRenderer(0).sharedMesh == character.GetMesh(0), "not whole");
            Expect.Throws<ArgumentException>(() => AnthroSave.SavePrefab(character, "Assets/Other.fbx"), "another extension");
            Scene.Destroy(character);
        }

        [Test(Description = "inspector: the error of a missing library or one of another release is shown, not thrown")]
        public static void MissingLibrary()
        {
            var character = new GameObject("person").AddComponent<AnthroCharacter>();
            var inspector = new AnthroCharacterEditor { target = character };
            foreach (var error in new Exception[] { new DllNotFoundException("gone"), new NotSupportedException("old") })
            {
                Draw(inspector, (label, value) =>
                {
                    if (label == "Body")
                    {
                        throw error;
                    }
                    return null;
                });
                Expect.That(EditorGUILayout.Shown.Contains(error.Message), "not shown");
            }
            Scene.Destroy(character);
        }
    }
}
