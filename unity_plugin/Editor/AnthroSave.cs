using System;
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>Characters and clips as assets of the project.</summary>
    public static class AnthroSave
    {
        /// <summary>
        /// Saves a character as a prefab. Beside it, in an asset of the same name, lie its request and as parts of that its
        /// meshes, avatar and those materials that were no assets. Character and prefab are baked from now on: they are not
        /// generated when they awake.
        /// </summary>
        /// <param name="character">It; generated now where it is not yet.</param>
        /// <param name="path">Such as `Assets/Person.prefab`. What is there is replaced.</param>
        /// <returns>The prefab.</returns>
        /// <exception cref="ArgumentException">The path does not end in .prefab.</exception>
        /// <exception cref="IOException">Unity could not save it; then no asset is left behind.</exception>
        public static GameObject SavePrefab(AnthroCharacter character, string path)
        {
            if (path == null || !path.EndsWith(".prefab", StringComparison.OrdinalIgnoreCase))
            {
                throw new ArgumentException("expected a path that ends in .prefab, got " + path, "path");
            }
            if (character.Body == null)
            {
                character.Generate();
            }
            var generate = character.GenerateOnAwake;
            var request = ScriptableObject.CreateInstance<AnthroRequestAsset>();
            request.name = Path.GetFileNameWithoutExtension(path);
            request.Request = character.Request.Copy();
            var asset = Path.ChangeExtension(path, ".asset");
            AssetDatabase.CreateAsset(request, asset);
            try
            {
                AddParts(character, request);
                character.Bake();
                bool saved;
                var prefab = PrefabUtility.SaveAsPrefabAsset(character.gameObject, path, out saved);
                if (!saved || prefab == null)
                {
                    throw new IOException("Unity did not save " + path);
                }
                AssetDatabase.SaveAssets();
                EditorUtility.SetDirty(character);
                return prefab;
            }
            catch
            {
                if (!character.IsBaked)
                {
                    character.Bake();
                }
                AssetDatabase.DeleteAsset(asset);
                // What it wore went with the asset.
                character.Generate();
                character.GenerateOnAwake = generate;
                throw;
            }
        }

        /// <summary>Adds what a character consists of to an asset.</summary>
        static void AddParts(AnthroCharacter character, AnthroRequestAsset to)
        {
            var copies = new Dictionary<Material, Material>();
            for (var lod = 0; lod <= 3; lod++)
            {
                var renderer = character.RendererOf(lod);
                if (renderer == null)
                {
                    continue;
                }
                Add(character.MeshOf(lod), to);
                var worn = renderer.sharedMaterials;
                for (var i = 0; i < worn.Length; i++)
                {
                    worn[i] = AsAsset(worn[i], copies, to);
                }
                renderer.sharedMaterials = worn;
            }
            if (character.Avatar != null)
            {
                Add(character.Avatar, to);
            }
        }

        /// <summary>A material that is an asset: itself, or a copy, as others wear it too.</summary>
        static Material AsAsset(Material material, Dictionary<Material, Material> copies, AnthroRequestAsset to)
        {
            if (material == null || AssetDatabase.Contains(material))
            {
                return material;
            }
            Material copy;
            if (!copies.TryGetValue(material, out copy))
            {
                copy = new Material(material);
                copy.name = material.name;
                Add(copy, to);
                copies[material] = copy;
            }
            return copy;
        }

        static void Add(UnityEngine.Object part, UnityEngine.Object to)
        {
            // Unity refuses to save what is marked as not to be saved.
            part.hideFlags = HideFlags.None;
            AssetDatabase.AddObjectToAsset(part, to);
        }

        /// <summary>A clip of ours as one of Unity's for an `Animator`, not saved yet.</summary>
        /// <param name="clip">It.</param>
        /// <param name="rig">The joints of the character that it is for.</param>
        /// <param name="loops">Whether it begins anew at its end.</param>
        public static AnimationClip ToAnimationClip(AnthroClip clip, AnthroRig rig, bool loops)
        {
            var made = AnthroCurves.NewClip(clip, false);
            foreach (var curve in AnthroCurves.Of(clip, rig))
            {
                // As it is called in the file: localRotation.x is m_LocalRotation.x.
                var property = "m_L" + curve.property.Substring(1);
                AnimationUtility.SetEditorCurve(
                    made, EditorCurveBinding.FloatCurve(curve.path, typeof(Transform), property), curve.keys);
            }
            made.EnsureQuaternionContinuity();
            var settings = AnimationUtility.GetAnimationClipSettings(made);
            settings.loopTime = loops;
            AnimationUtility.SetAnimationClipSettings(made, settings);
            return made;
        }

        /// <summary>Saves a clip of ours as one of Unity's for an `Animator`.</summary>
        /// <param name="path">Such as `Assets/Walk.anim`.</param>
        public static AnimationClip SaveClip(AnthroClip clip, AnthroRig rig, bool loops, string path)
        {
            var made = ToAnimationClip(clip, rig, loops);
            AssetDatabase.CreateAsset(made, path);
            return made;
        }
    }
}
