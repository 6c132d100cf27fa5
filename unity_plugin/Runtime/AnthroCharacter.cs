using System;
using System.Collections;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// A person in the scene: made of its request, with a skeleton, a mesh per level of detail and a humanoid avatar.
    /// Generating again changes it in place: objects, transforms and meshes stay the same ones.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Character")]
    [DisallowMultipleComponent]
    public sealed class AnthroCharacter : MonoBehaviour
    {
        [SerializeField] AnthroRequest request = new AnthroRequest();
        [SerializeField] [Range(0, 3)] int finestLod = 0;
        [SerializeField] [Range(0, 3)] int coarsestLod = 3;
        [SerializeField] [Range(0, 10)] int skinTone = 0;
        [SerializeField] bool bodyOnly = false;
        [SerializeField] bool humanoid = true;
        [SerializeField] bool generateOnAwake = true;
        [SerializeField] Material[] materials = new Material[0];

        // Survives a reload of the code, saving and copying, when what is known of these objects does not.
        [SerializeField] [HideInInspector] List<GameObject> made = new List<GameObject>();

        readonly List<Level> levels = new List<Level>();
        AnthroBody body;
        AnthroRig rig;
        Avatar avatar;

        sealed class Level
        {
            public int lod;
            public Mesh mesh;
            public SkinnedMeshRenderer renderer;
        }

        /// <summary>Called on the main thread when the character has become a body. The body is the character's.</summary>
        public event Action<AnthroBody> OnReport;

        /// <summary>Who it is to be; takes effect with `Generate`.</summary>
        public AnthroRequest Request
        {
            get { return request; }
            set { request = value ?? new AnthroRequest(); }
        }

        /// <summary>Who it is; null before it is generated. Freed with the character, or when it becomes another.</summary>
        public AnthroBody Body
        {
            get { return body; }
        }

        /// <summary>Its joints; null before it is generated.</summary>
        public AnthroRig Rig
        {
            get { return rig; }
        }

        /// <summary>Its humanoid avatar; null where it has none.</summary>
        public Avatar Avatar
        {
            get { return avatar; }
        }

        /// <summary>The finest level of detail that it gets, 0 to 3. Takes effect with the first `Generate`.</summary>
        public int FinestLod
        {
            get { return finestLod; }
            set { finestLod = Mathf.Clamp(value, 0, 3); }
        }

        /// <summary>The coarsest level of detail that it gets, 0 to 3. Takes effect with the first `Generate`.</summary>
        public int CoarsestLod
        {
            get { return coarsestLod; }
            set { coarsestLod = Mathf.Clamp(value, 0, 3); }
        }

        /// <summary>Step of the Monk scale, 1 to 10; 0 for the default. Takes effect with `Generate`.</summary>
        public int SkinTone
        {
            get { return skinTone; }
            set { skinTone = Mathf.Clamp(value, 0, 10); }
        }

        /// <summary>Whether an avatar is built. Takes effect with `Generate`.</summary>
        public bool Humanoid
        {
            get { return humanoid; }
            set { humanoid = value; }
        }

        /// <summary>Whether `Awake` generates it.</summary>
        public bool GenerateOnAwake
        {
            get { return generateOnAwake; }
            set { generateOnAwake = value; }
        }

        /// <summary>Materials to use instead of the made ones, by part; missing ones are made.</summary>
        public Material[] Materials
        {
            get { return materials; }
            set { materials = value ?? new Material[0]; }
        }

        /// <summary>The mesh of a level of detail; null where it has none.</summary>
        public Mesh MeshOf(int lod)
        {
            var level = levels.Find(one => one.lod == lod);
            return level == null ? null : level.mesh;
        }

        /// <summary>The renderer of a level of detail; null where it has none.</summary>
        public SkinnedMeshRenderer RendererOf(int lod)
        {
            var level = levels.Find(one => one.lod == lod);
            return level == null ? null : level.renderer;
        }

        void Awake()
        {
            if (generateOnAwake && body == null)
            {
                Generate();
            }
        }

        /// <summary>Makes it the person that the request describes, at once.</summary>
        /// <exception cref="AnthroException">The request is refused; the character stays as it was.</exception>
        public void Generate()
        {
            Become(AnthroModel.Default.Generate(request));
        }

        /// <summary>Makes it a body, at once. The body is the character's from now on.</summary>
        public void Become(AnthroBody next)
        {
            for (var steps = BecomeInSteps(next); steps.MoveNext();)
            {
            }
        }

        /// <summary>As `Become`, in steps of a few milliseconds: one for the joints, one per level of detail, one for the
        /// avatar.</summary>
        public IEnumerator BecomeInSteps(AnthroBody next)
        {
            if (next == null)
            {
                throw new ArgumentNullException("next");
            }
            if (body != null && !ReferenceEquals(body, next))
            {
                body.Dispose();
            }
            body = next;
            if (rig == null)
            {
                // Made before a reload, or those of the character that this one is a copy of: names must not stand twice.
                foreach (var old in made)
                {
                    if (old != null)
                    {
                        DestroyImmediate(old);
                    }
                }
                made.Clear();
                rig = AnthroRig.Create(body, transform);
                made.Add(rig.Bones[0].gameObject);
            }
            else
            {
                rig.Update(body);
            }
            yield return null;
            if (levels.Count == 0)
            {
                for (var lod = Mathf.Min(finestLod, coarsestLod); lod <= Mathf.Max(finestLod, coarsestLod); lod++)
                {
                    AddLevel(lod);
                    yield return null;
                }
                Group();
            }
            else
            {
                foreach (var level in levels)
                {
                    UpdateLevel(level);
                    yield return null;
                }
            }
            if (humanoid)
            {
                BuildAvatar();
            }
            if (OnReport != null)
            {
                OnReport(body);
            }
        }

        /// <summary>
        /// Adds a blend shape to all levels of detail that leads to the surface of another body, such as a heavier one; its
        /// weight goes from 0 to 100. It is lost when the character becomes another body.
        /// </summary>
        public void AddBlendShape(string shape, AnthroBody to)
        {
            if (body == null)
            {
                throw new InvalidOperationException("the character has to be generated before it gets blend shapes");
            }
            foreach (var level in levels)
            {
                using (var surface = new AnthroSurface(body, level.lod, skinTone, bodyOnly))
                {
                    surface.AddBlendShape(shape, to);
                    AnthroMeshes.AddBlendShapes(level.mesh, surface);
                }
            }
        }

        void AddLevel(int lod)
        {
            var level = new Level();
            level.lod = lod;
            var child = new GameObject("LOD" + lod);
            child.transform.SetParent(transform, false);
            made.Add(child);
            level.renderer = child.AddComponent<SkinnedMeshRenderer>();
            levels.Add(level);
            using (var surface = new AnthroSurface(body, lod, skinTone, bodyOnly))
            {
                level.mesh = AnthroMeshes.Create(surface, rig.Joints, name + " LOD" + lod);
                level.renderer.sharedMesh = level.mesh;
                level.renderer.bones = rig.Bones;
                level.renderer.rootBone = rig.Bones[1];
                Dress(level, surface);
            }
        }

        void UpdateLevel(Level level)
        {
            using (var surface = new AnthroSurface(body, level.lod, skinTone, bodyOnly))
            {
                AnthroMeshes.Update(level.mesh, surface, rig.Joints);
                Dress(level, surface);
            }
        }

        void Dress(Level level, AnthroSurface surface)
        {
            var worn = new Material[surface.PartCount];
            for (var i = 0; i < worn.Length; i++)
            {
                var own = i < materials.Length && materials[i] != null;
                worn[i] = own ? materials[i] : AnthroMaterials.Of(surface.Part(i));
            }
            level.renderer.sharedMaterials = worn;
            // Around the pelvis, whose space they are in; half as far again as the bind pose reaches is room for any pose.
            var size = level.mesh.bounds.size;
            var reach = 1.5f * Mathf.Max(size.x, Mathf.Max(size.y, size.z));
            level.renderer.localBounds = new Bounds(Vector3.zero, new Vector3(reach, reach, reach));
        }

        void Group()
        {
            if (levels.Count < 2)
            {
                return;
            }
            var group = GetComponent<LODGroup>();
            if (group == null)
            {
                group = gameObject.AddComponent<LODGroup>();
            }
            var heights = new[] { 0.5f, 0.2f, 0.08f, 0.01f };
            var lods = new LOD[levels.Count];
            for (var i = 0; i < lods.Length; i++)
            {
                lods[i] = new LOD(heights[i + heights.Length - lods.Length], new Renderer[] { levels[i].renderer });
            }
            group.SetLODs(lods);
            group.RecalculateBounds();
        }

        void BuildAvatar()
        {
            var before = avatar;
            avatar = AnthroHumanoid.Build(rig, gameObject);
            if (avatar != null)
            {
                var animator = GetComponent<Animator>();
                if (animator == null)
                {
                    animator = gameObject.AddComponent<Animator>();
                }
                animator.avatar = avatar;
            }
            Discard(before);
        }

        void OnDestroy()
        {
            foreach (var level in levels)
            {
                Discard(level.mesh);
            }
            levels.Clear();
            Discard(avatar);
            avatar = null;
            if (body != null)
            {
                body.Dispose();
                body = null;
            }
        }

        static void Discard(UnityEngine.Object made)
        {
            if (made == null)
            {
                return;
            }
            if (Application.isPlaying)
            {
                Destroy(made);
            }
            else
            {
                DestroyImmediate(made);
            }
        }
    }
}
