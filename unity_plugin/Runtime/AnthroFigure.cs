using System.Collections;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// The objects that a character consists of: joints, a renderer and a mesh per level of detail, the LODGroup, the
    /// avatar. Existing ones are reused: after a domain reload, in a duplicate, in a prefab instance.
    /// </summary>
    internal sealed class AnthroFigure
    {
        /// <summary>A level of detail.</summary>
        public sealed class Level
        {
            public int lod;
            public Mesh mesh;
            public SkinnedMeshRenderer renderer;
        }

        static readonly float[] screenHeights = { 0.5f, 0.2f, 0.08f, 0.01f };

        readonly AnthroCharacter character;
        readonly List<GameObject> made;
        readonly List<Object> owned;
        LODGroup group;

        /// <summary>An empty figure.</summary>
        /// <param name="character">The character.</param>
        /// <param name="made">Child objects of the character: existing ones are reused, new ones are added.</param>
        /// <param name="owned">Receives the meshes and the avatar that the character owns.</param>
        public AnthroFigure(AnthroCharacter character, List<GameObject> made, List<Object> owned)
        {
            this.character = character;
            this.made = made;
            this.owned = owned;
            made.RemoveAll(child => child == null);
        }

        public readonly List<Level> Levels = new List<Level>();

        public AnthroRig Rig { get; private set; }

        public Avatar Avatar { get; private set; }

        /// <summary>Whether eyes, teeth, tongue and eyelashes are left out.</summary>
        public bool BodyOnly { get; private set; }

        /// <summary>In edit mode generated objects are not saved: the scene has the request and generates them
        /// again.</summary>
        static HideFlags GeneratedFlags
        {
            get { return Application.isPlaying ? HideFlags.None : HideFlags.DontSave; }
        }

        /// <summary>The levels of detail between two, in either order; finest first.</summary>
        public static List<int> LodRange(int finest, int coarsest)
        {
            var lods = new List<int>();
            for (var lod = Mathf.Min(finest, coarsest); lod <= Mathf.Max(finest, coarsest); lod++)
            {
                lods.Add(lod);
            }
            return lods;
        }

        /// <summary>Makes the figure in steps; nothing is visible before the last one.</summary>
        public IEnumerator Make(AnthroBuild build, IList<int> lods, bool humanoid)
        {
            BodyOnly = build.BodyOnly;
            var unused = new List<GameObject>(made);
            MakeRig(build.Body, unused);
            yield return null;
            foreach (var lod in lods)
            {
                var level = AddLevel(build, lod, unused);
                yield return null;
                Bind(level, build[lod]);
                yield return null;
            }
            foreach (var child in unused)
            {
                made.Remove(child);
                AnthroObjects.DestroySafely(child);
            }
            MakeGroup();
            UpdateGroupBounds(build);
            if (humanoid)
            {
                BuildAvatar();
                yield return null;
            }
            foreach (var level in Levels)
            {
                level.renderer.enabled = true;
            }
        }

        /// <summary>Updates the figure to another body, synchronously: GameObjects, transforms and meshes are
        /// kept.</summary>
        public void Update(AnthroBuild build, bool humanoid)
        {
            var partsChanged = BodyOnly != build.BodyOnly;
            BodyOnly = build.BodyOnly;
            Rig.Update(build.Body);
            foreach (var level in Levels)
            {
                var packed = build[level.lod];
                if (partsChanged)
                {
                    Replace(level, packed);
                    continue;
                }
                AnthroMeshes.Update(level.mesh, packed, Rig.Joints);
                ApplyMaterials(level, packed);
            }
            UpdateGroupBounds(build);
            if (humanoid)
            {
                BuildAvatar();
            }
        }

        /// <summary>Destroys the owned meshes and the avatar; GameObjects stay.</summary>
        public void DestroyOwned()
        {
            foreach (var level in Levels)
            {
                DestroyOwned(level.mesh);
            }
            Levels.Clear();
            DestroyOwned(Avatar);
            Avatar = null;
        }

        /// <summary>Gives up ownership of meshes and avatar, which became assets, and makes all objects
        /// savable.</summary>
        public void Bake()
        {
            owned.Clear();
            foreach (var level in Levels)
            {
                level.mesh.hideFlags = HideFlags.None;
            }
            if (Avatar != null)
            {
                Avatar.hideFlags = HideFlags.None;
            }
            foreach (var child in made)
            {
                MakeSavable(child.transform);
            }
            MakeSavable<LODGroup>();
            MakeSavable<Animator>();
        }

        void MakeSavable<T>() where T : Component
        {
            var part = character.GetComponent<T>();
            if (part != null)
            {
                part.hideFlags = HideFlags.None;
            }
        }

        static void MakeSavable(Transform at)
        {
            at.gameObject.hideFlags = HideFlags.None;
            for (var i = 0; i < at.childCount; i++)
            {
                MakeSavable(at.GetChild(i));
            }
        }

        void MakeRig(AnthroBody body, List<GameObject> unused)
        {
            foreach (var child in unused)
            {
                Rig = AnthroRig.Adopt(body, child.transform);
                if (Rig != null)
                {
                    unused.Remove(child);
                    return;
                }
            }
            Rig = AnthroRig.Create(body, character.transform);
            foreach (var bone in Rig.Bones)
            {
                bone.gameObject.hideFlags = GeneratedFlags;
            }
            made.Add(Rig.Bones[0].gameObject);
        }

        /// <summary>Adds a level of detail with its renderer and a mesh that has no bone weights yet.</summary>
        Level AddLevel(AnthroBuild build, int lod, List<GameObject> unused)
        {
            var level = new Level();
            level.lod = lod;
            var name = "LOD" + lod;
            var child = unused.Find(one => one.name == name && one.GetComponent<SkinnedMeshRenderer>() != null);
            if (child == null)
            {
                child = new GameObject(name);
                child.hideFlags = GeneratedFlags;
                child.transform.SetParent(character.transform, false);
                made.Add(child);
                child.AddComponent<SkinnedMeshRenderer>().enabled = false;
            }
            unused.Remove(child);
            level.renderer = child.GetComponent<SkinnedMeshRenderer>();
            Levels.Add(level);
            Fill(level, build[lod]);
            return level;
        }

        void Fill(Level level, AnthroPacked packed)
        {
            level.mesh = AnthroMeshes.Fill(packed, character.name + " LOD" + level.lod);
            level.mesh.hideFlags = GeneratedFlags;
            owned.Add(level.mesh);
        }

        void Bind(Level level, AnthroPacked packed)
        {
            AnthroMeshes.Bind(level.mesh, packed, Rig.Joints);
            level.renderer.sharedMesh = level.mesh;
            level.renderer.bones = Rig.Bones;
            level.renderer.rootBone = Rig.Bones[1];
            ApplyMaterials(level, packed);
        }

        /// <summary>Replaces the mesh by one with other parts.</summary>
        void Replace(Level level, AnthroPacked packed)
        {
            var before = level.mesh;
            Fill(level, packed);
            Bind(level, packed);
            DestroyOwned(before);
        }

        void ApplyMaterials(Level level, AnthroPacked packed)
        {
            var own = character.Materials;
            var materials = new Material[packed.Parts.Length];
            for (var i = 0; i < materials.Length; i++)
            {
                materials[i] = i < own.Length && own[i] != null ? own[i] : AnthroMaterials.Get(packed.Parts[i]);
            }
            level.renderer.sharedMaterials = materials;
            // Relative to the pelvis, the root bone; half as large again as the bind pose, which leaves room for any
            // pose.
            var size = packed.TotalBounds.size;
            var reach = 1.5f * Mathf.Max(size.x, Mathf.Max(size.y, size.z));
            level.renderer.localBounds = new Bounds(Vector3.zero, new Vector3(reach, reach, reach));
        }

        void MakeGroup()
        {
            group = character.GetComponent<LODGroup>();
            if (Levels.Count < 2)
            {
                return;
            }
            if (group == null)
            {
                group = character.gameObject.AddComponent<LODGroup>();
                group.hideFlags = GeneratedFlags;
            }
            var lods = new LOD[Levels.Count];
            for (var i = 0; i < lods.Length; i++)
            {
                lods[i] = new LOD(screenHeights[i + screenHeights.Length - lods.Length], new Renderer[] { Levels[i].renderer });
            }
            group.SetLODs(lods);
        }

        /// <summary>Sets the size of the LODGroup from the mesh: the renderers' bounds include room for poses.</summary>
        void UpdateGroupBounds(AnthroBuild build)
        {
            if (group != null)
            {
                var around = build[Levels[0].lod].TotalBounds;
                group.localReferencePoint = around.center;
                group.size = Mathf.Max(around.size.x, Mathf.Max(around.size.y, around.size.z));
            }
        }

        void BuildAvatar()
        {
            var before = Avatar;
            Avatar = AnthroHumanoid.Build(Rig, character.gameObject);
            if (Avatar != null)
            {
                Avatar.hideFlags = GeneratedFlags;
                owned.Add(Avatar);
                var animator = character.GetComponent<Animator>();
                if (animator == null)
                {
                    animator = character.gameObject.AddComponent<Animator>();
                    animator.hideFlags = GeneratedFlags;
                }
                var state = AnthroAnimatorState.Capture(animator);
                animator.avatar = Avatar;
                state.Restore(animator);
            }
            DestroyOwned(before);
        }

        void DestroyOwned(Object one)
        {
            owned.Remove(one);
            AnthroObjects.DestroySafely(one);
        }
    }
}
