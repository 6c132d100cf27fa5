using System;
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

namespace Anthronet.Editor
{
    /// <summary>Saves characters and clips as project assets.</summary>
    public static class AnthroSave
    {
        /// <summary>
        /// Saves a character as a prefab. An asset of the same name beside it holds the request, with meshes, avatar and
        /// generated materials as sub-assets. Character and prefab are baked from then on: they are not generated in
        /// `Awake`.
        /// </summary>
        /// <param name="character">The character; it is generated first if necessary.</param>
        /// <param name="path">A path such as `Assets/Person.prefab`. Existing assets are replaced.</param>
        /// <returns>The prefab.</returns>
        /// <exception cref="ArgumentException">The path does not end in .prefab.</exception>
        /// <exception cref="IOException">Unity could not save the prefab; no asset is left behind.</exception>
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
                    throw new IOException("Unity could not save " + path);
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
                // Its meshes and avatar were deleted with the asset.
                character.Generate();
                character.GenerateOnAwake = generate;
                throw;
            }
        }

        /// <summary>Adds the meshes, avatar and materials of a character to an asset.</summary>
        static void AddParts(AnthroCharacter character, AnthroRequestAsset to)
        {
            var copies = new Dictionary<Material, Material>();
            for (var lod = 0; lod <= 3; lod++)
            {
                var renderer = character.GetRenderer(lod);
                if (renderer == null)
                {
                    continue;
                }
                Add(character.GetMesh(lod), to);
                var materials = renderer.sharedMaterials;
                for (var i = 0; i < materials.Length; i++)
                {
                    materials[i] = AsAsset(materials[i], copies, to);
                }
                renderer.sharedMaterials = materials;
            }
            if (character.Avatar != null)
            {
                Add(character.Avatar, to);
            }
        }

        /// <summary>A material as an asset: the material itself, or a copy, since other characters share it.</summary>
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
            // Unity refuses to save objects that are flagged as not to be saved.
            part.hideFlags = HideFlags.None;
            AssetDatabase.AddObjectToAsset(part, to);
        }

        /// <summary>Converts a clip to an `AnimationClip` for an `Animator`; it is not saved yet.</summary>
        /// <param name="clip">The clip.</param>
        /// <param name="rig">The skeleton of the character.</param>
        /// <param name="loops">Whether the animation clip loops (Loop Time).</param>
        public static AnimationClip ToAnimationClip(AnthroClip clip, AnthroRig rig, bool loops)
        {
            var made = AnthroCurves.NewClip(clip, false);
            foreach (var curve in AnthroCurves.FromClip(clip, rig))
            {
                // Serialised property names: localRotation.x is m_LocalRotation.x.
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

        /// <summary>Saves a clip as an `AnimationClip` asset for an `Animator`.</summary>
        /// <param name="path">A path such as `Assets/Walk.anim`.</param>
        public static AnimationClip SaveClip(AnthroClip clip, AnthroRig rig, bool loops, string path)
        {
            var made = ToAnimationClip(clip, rig, loops);
            AssetDatabase.CreateAsset(made, path);
            return made;
        }
    }
}
