using System.Collections;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// The objects that a character consists of: joints, a renderer and a mesh per level of detail, the group of levels,
    /// the avatar. What is there already is used again: after a reload of the code, in a copy, in an instance of a prefab.
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

        static readonly float[] heights = { 0.5f, 0.2f, 0.08f, 0.01f };

        readonly AnthroCharacter home;
        readonly List<GameObject> made;
        readonly List<Object> owned;
        LODGroup group;

        /// <summary>Nothing yet.</summary>
        /// <param name="home">The character.</param>
        /// <param name="made">Children that are the character's: what is found is used again, what is made is added.</param>
        /// <param name="owned">Meshes and avatar of its own, added and taken off.</param>
        public AnthroFigure(AnthroCharacter home, List<GameObject> made, List<Object> owned)
        {
            this.home = home;
            this.made = made;
            this.owned = owned;
            made.RemoveAll(child => child == null);
        }

        public readonly List<Level> Levels = new List<Level>();

        public AnthroRig Rig { get; private set; }

        public Avatar Avatar { get; private set; }

        /// <summary>Whether it is without eyes, teeth, tongue and lashes.</summary>
        public bool BodyOnly { get; private set; }

        /// <summary>In the editor's edit mode what is generated is not saved: the request is, and makes it again.</summary>
        static HideFlags Flags
        {
            get { return Application.isPlaying ? HideFlags.None : HideFlags.DontSave; }
        }

        /// <summary>The levels of detail between two, in whichever order they are given; the finest first.</summary>
        public static List<int> LodRange(int finest, int coarsest)
        {
            var lods = new List<int>();
            for (var lod = Mathf.Min(finest, coarsest); lod <= Mathf.Max(finest, coarsest); lod++)
            {
                lods.Add(lod);
            }
            return lods;
        }

        /// <summary>Makes it of a body in steps, with nothing to be seen before the last.</summary>
        public IEnumerator Make(AnthroBuild build, IList<int> lods, bool humanoid)
        {
            BodyOnly = build.BodyOnly;
            var left = new List<GameObject>(made);
            MakeRig(build.Body, left);
            yield return null;
            foreach (var lod in lods)
            {
                var level = AddLevel(build, lod, left);
                yield return null;
                Bind(level, build[lod]);
                yield return null;
            }
            foreach (var child in left)
            {
                made.Remove(child);
                AnthroObjects.Discard(child);
            }
            Group();
            Measure(build);
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

        /// <summary>Makes it another body, at once: objects, transforms and meshes stay the same ones.</summary>
        public void Update(AnthroBuild build, bool humanoid)
        {
            var whole = BodyOnly != build.BodyOnly;
            BodyOnly = build.BodyOnly;
            Rig.Update(build.Body);
            foreach (var level in Levels)
            {
                var packed = build[level.lod];
                if (whole)
                {
                    Replace(level, packed);
                    continue;
                }
                AnthroMeshes.Update(level.mesh, packed, Rig.Joints);
                Dress(level, packed);
            }
            Measure(build);
            if (humanoid)
            {
                BuildAvatar();
            }
        }

        /// <summary>Destroys what is its own and no object: meshes and avatar.</summary>
        public void Drop()
        {
            foreach (var level in Levels)
            {
                Disown(level.mesh);
            }
            Levels.Clear();
            Disown(Avatar);
            Avatar = null;
        }

        /// <summary>Lets go of meshes and avatar, which are assets from now on, and lets all objects be saved.</summary>
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
                Show(child.transform);
            }
            Show<LODGroup>();
            Show<Animator>();
        }

        void Show<T>() where T : Component
        {
            var part = home.GetComponent<T>();
            if (part != null)
            {
                part.hideFlags = HideFlags.None;
            }
        }

        static void Show(Transform at)
        {
            at.gameObject.hideFlags = HideFlags.None;
            for (var i = 0; i < at.childCount; i++)
            {
                Show(at.GetChild(i));
            }
        }

        void MakeRig(AnthroBody body, List<GameObject> left)
        {
            foreach (var child in left)
            {
                Rig = AnthroRig.Adopt(body, child.transform);
                if (Rig != null)
                {
                    left.Remove(child);
                    return;
                }
            }
            Rig = AnthroRig.Create(body, home.transform);
            foreach (var bone in Rig.Bones)
            {
                bone.gameObject.hideFlags = Flags;
            }
            made.Add(Rig.Bones[0].gameObject);
        }

        /// <summary>A level with its renderer and a mesh that has no weights yet.</summary>
        Level AddLevel(AnthroBuild build, int lod, List<GameObject> left)
        {
            var level = new Level();
            level.lod = lod;
            var name = "LOD" + lod;
            var child = left.Find(one => one.name == name && one.GetComponent<SkinnedMeshRenderer>() != null);
            if (child == null)
            {
                child = new GameObject(name);
                child.hideFlags = Flags;
                child.transform.SetParent(home.transform, false);
                made.Add(child);
                child.AddComponent<SkinnedMeshRenderer>().enabled = false;
            }
            left.Remove(child);
            level.renderer = child.GetComponent<SkinnedMeshRenderer>();
            Levels.Add(level);
            Fill(level, build[lod]);
            return level;
        }

        void Fill(Level level, AnthroPacked packed)
        {
            level.mesh = AnthroMeshes.Fill(packed, home.name + " LOD" + level.lod);
            level.mesh.hideFlags = Flags;
            owned.Add(level.mesh);
        }

        void Bind(Level level, AnthroPacked packed)
        {
            AnthroMeshes.Bind(level.mesh, packed, Rig.Joints);
            level.renderer.sharedMesh = level.mesh;
            level.renderer.bones = Rig.Bones;
            level.renderer.rootBone = Rig.Bones[1];
            Dress(level, packed);
        }

        /// <summary>Another mesh, of other parts.</summary>
        void Replace(Level level, AnthroPacked packed)
        {
            var before = level.mesh;
            Fill(level, packed);
            Bind(level, packed);
            Disown(before);
        }

        void Dress(Level level, AnthroPacked packed)
        {
            var own = home.Materials;
            var worn = new Material[packed.Parts.Length];
            for (var i = 0; i < worn.Length; i++)
            {
                worn[i] = i < own.Length && own[i] != null ? own[i] : AnthroMaterials.Of(packed.Parts[i]);
            }
            level.renderer.sharedMaterials = worn;
            // Around the pelvis, whose space they are in; half as far again as the bind pose reaches is room for any pose.
            var size = packed.Around.size;
            var reach = 1.5f * Mathf.Max(size.x, Mathf.Max(size.y, size.z));
            level.renderer.localBounds = new Bounds(Vector3.zero, new Vector3(reach, reach, reach));
        }

        void Group()
        {
            group = home.GetComponent<LODGroup>();
            if (Levels.Count < 2)
            {
                return;
            }
            if (group == null)
            {
                group = home.gameObject.AddComponent<LODGroup>();
                group.hideFlags = Flags;
            }
            var lods = new LOD[Levels.Count];
            for (var i = 0; i < lods.Length; i++)
            {
                lods[i] = new LOD(heights[i + heights.Length - lods.Length], new Renderer[] { Levels[i].renderer });
            }
            group.SetLODs(lods);
        }

        /// <summary>Tells the group how large the body is: of its mesh, since the renderers' bounds have room for poses.
        /// </summary>
        void Measure(AnthroBuild build)
        {
            if (group != null)
            {
                var around = build[Levels[0].lod].Around;
                group.localReferencePoint = around.center;
                group.size = Mathf.Max(around.size.x, Mathf.Max(around.size.y, around.size.z));
            }
        }

        void BuildAvatar()
        {
            var before = Avatar;
            Avatar = AnthroHumanoid.Build(Rig, home.gameObject);
            if (Avatar != null)
            {
                Avatar.hideFlags = Flags;
                owned.Add(Avatar);
                var animator = home.GetComponent<Animator>();
                if (animator == null)
                {
                    animator = home.gameObject.AddComponent<Animator>();
                    animator.hideFlags = Flags;
                }
                var state = AnthroAnimatorState.Of(animator);
                animator.avatar = Avatar;
                state.To(animator);
            }
            Disown(before);
        }

        void Disown(Object one)
        {
            owned.Remove(one);
            AnthroObjects.Discard(one);
        }
    }
}
