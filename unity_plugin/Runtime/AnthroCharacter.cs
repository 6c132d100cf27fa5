using System;
using System.Collections;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// A person in the scene: made of its request, with a skeleton, a mesh per level of detail and a humanoid avatar.
    /// Generating again changes it in place: objects, transforms and meshes stay the same ones. In the editor's edit mode
    /// what it generates is not saved with the scene, but made again when the scene opens. A copy generates itself from the
    /// request, too: one that became a body by other ways becomes who its request says.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Character")]
    [DisallowMultipleComponent]
    [ExecuteAlways]
    public sealed class AnthroCharacter : MonoBehaviour
    {
        [SerializeField] AnthroRequest request = new AnthroRequest();
        [SerializeField] AnthroRequestAsset requestAsset = null;
        [SerializeField] [Range(0, 3)] int finestLod = 0;
        [SerializeField] [Range(0, 3)] int coarsestLod = 3;
        [SerializeField] [Range(0, 10)] int skinTone = 0;
        [SerializeField] bool bodyOnly = false;
        [SerializeField] bool humanoid = true;
        [SerializeField] bool generateOnAwake = true;
        [SerializeField] Material[] materials = new Material[0];

        // These survive a reload of the code, and copying: then the former are the copy's own, the latter the original's.
        [SerializeField] [HideInInspector] List<GameObject> made = new List<GameObject>();
        [SerializeField] [HideInInspector] List<UnityEngine.Object> owned = new List<UnityEngine.Object>();
        [SerializeField] [HideInInspector] int owner;
        [SerializeField] [HideInInspector] bool baked;

        AnthroBody body;
        AnthroFigure figure;
        AnthroFigure half;
        int turns;

        /// <summary>Called on the main thread when the character has become a body. The body is the character's.</summary>
        public event Action<AnthroBody> OnReport;

        /// <summary>Who it is to be; takes effect with `Generate`. Of the asset where it has one;
        /// setting another takes the asset off.</summary>
        public AnthroRequest Request
        {
            get { return requestAsset != null ? requestAsset.Request : request; }
            set
            {
                requestAsset = null;
                request = value ?? new AnthroRequest();
            }
        }

        /// <summary>An asset that says who it is to be, instead of a request of its own; null for none.</summary>
        public AnthroRequestAsset RequestAsset
        {
            get { return requestAsset; }
            set { requestAsset = value; }
        }

        /// <summary>Who it is; null before it is generated, and in a baked one. Freed with the character, or when it becomes
        /// another.</summary>
        public AnthroBody Body
        {
            get { return body; }
        }

        /// <summary>Its joints; null before it is generated, and in a baked one.</summary>
        public AnthroRig Rig
        {
            get { return figure == null ? null : figure.Rig; }
        }

        /// <summary>Its humanoid avatar; null where it has none.</summary>
        public Avatar Avatar
        {
            get { return figure == null ? null : figure.Avatar; }
        }

        /// <summary>Whether its meshes and avatar are assets, saved by the editor: then it is not generated when it awakes.
        /// `Generate` makes it one that is.</summary>
        public bool IsBaked
        {
            get { return baked; }
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

        /// <summary>Whether it is without eyes, teeth, tongue and lashes. Takes effect with `Generate`.</summary>
        public bool BodyOnly
        {
            get { return bodyOnly; }
            set { bodyOnly = value; }
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
            var level = LevelOf(lod);
            return level == null ? null : level.mesh;
        }

        /// <summary>The renderer of a level of detail; null where it has none.</summary>
        public SkinnedMeshRenderer RendererOf(int lod)
        {
            var level = LevelOf(lod);
            return level == null ? null : level.renderer;
        }

        AnthroFigure.Level LevelOf(int lod)
        {
            return figure == null ? null : figure.Levels.Find(one => one.lod == lod);
        }

        void Awake()
        {
            // Of one that is enabled Unity calls `OnEnable` next: once is enough to be told what is wrong.
            if (!enabled)
            {
                Wake();
            }
        }

        // After a reload of the code it is this alone that Unity calls.
        void OnEnable()
        {
            Wake();
        }

        /// <summary>Generates what has no body: a new one if it is to, and always one that had been generated before its
        /// code was loaded anew or it was copied. What fails is told, since nobody could catch it.</summary>
        void Wake()
        {
            if (body != null && body.IsFreed)
            {
                // Released before the code was to be loaded anew, which then did not happen.
                body = null;
            }
            if (baked || body != null || half != null || !(generateOnAwake || made.Exists(child => child != null)))
            {
                return;
            }
            try
            {
                Generate();
            }
            catch (Exception error)
            {
                Debug.LogException(error, this);
            }
        }

        /// <summary>Makes it the person that the request describes, at once.</summary>
        /// <exception cref="AnthroException">The request is refused; the character stays as it was.</exception>
        public void Generate()
        {
            Become(AnthroModel.Default.Generate(Request));
        }

        /// <summary>Makes it a body, at once. The body is the character's from now on.</summary>
        public void Become(AnthroBody next)
        {
            for (var steps = BecomeInSteps(next); steps.MoveNext();)
            {
            }
        }

        /// <summary>
        /// As `Become`, in steps of a few milliseconds. Until the last it stays who it was, or is not to be seen if it was
        /// nobody; where the steps are not taken to their end it stays so. Another `Become` in between wins.
        /// </summary>
        public IEnumerator BecomeInSteps(AnthroBody next)
        {
            Native.Library.NotNull(next, "next");
            return Steps(new AnthroBuild(next, skinTone, bodyOnly));
        }

        /// <summary>As `BecomeInSteps`, of what may be packed already. Takes body and build.</summary>
        internal IEnumerator Steps(AnthroBuild build)
        {
            var turn = ++turns;
            var next = build.Body;
            var done = false;
            try
            {
                var lods = Lods();
                var whole = figure == null || figure.BodyOnly != build.BodyOnly;
                foreach (var lod in lods)
                {
                    if (build.Pack(lod, whole))
                    {
                        yield return null;
                    }
                    if (turn != turns || this == null)
                    {
                        yield break;
                    }
                }
                if (figure != null)
                {
                    figure.Update(build, humanoid);
                }
                else
                {
                    Begin();
                    for (var steps = half.Make(build, lods, humanoid); steps.MoveNext();)
                    {
                        yield return null;
                        if (turn != turns || this == null)
                        {
                            yield break;
                        }
                    }
                    figure = half;
                    half = null;
                }
                done = true;
            }
            finally
            {
                build.Dispose();
                if (!done && !ReferenceEquals(next, body))
                {
                    next.Dispose();
                }
            }
            if (body != null && !ReferenceEquals(body, next))
            {
                body.Dispose();
            }
            body = next;
            if (OnReport != null)
            {
                OnReport(body);
            }
        }

        /// <summary>A figure to make, in place of one that was not taken to its end.</summary>
        void Begin()
        {
            if (half != null)
            {
                half.Drop();
            }
            if (owner == GetInstanceID())
            {
                // What it had before a reload of the code; those of the one that this is a copy of stay.
                owned.ForEach(AnthroObjects.Discard);
            }
            owned.Clear();
            owner = GetInstanceID();
            if (baked)
            {
                baked = false;
                // Assets stay in the project, and the scene would hold renderers without a mesh.
                generateOnAwake = true;
            }
            half = new AnthroFigure(this, made, owned);
        }

        List<int> Lods()
        {
            if (figure != null)
            {
                return figure.Levels.ConvertAll(level => level.lod);
            }
            return AnthroFigure.LodRange(finestLod, coarsestLod);
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
            foreach (var level in figure.Levels)
            {
                using (var surface = new AnthroSurface(body, level.lod, skinTone, figure.BodyOnly))
                {
                    surface.AddBlendShape(shape, to);
                    AnthroMeshes.AddBlendShapes(level.mesh, surface);
                }
            }
        }

        /// <summary>Takes all blend shapes off, as Unity takes no single one.</summary>
        public void ClearBlendShapes()
        {
            for (var i = 0; figure != null && i < figure.Levels.Count; i++)
            {
                figure.Levels[i].mesh.ClearBlendShapes();
            }
        }

        internal bool HasBlendShape(string shape)
        {
            return figure != null && figure.Levels.TrueForAll(level => level.mesh.GetBlendShapeIndex(shape) >= 0);
        }

        /// <summary>Sets how much of a blend shape is seen, 0 to 100, on all levels of detail. Makes no garbage.</summary>
        /// <exception cref="ArgumentException">It has none of that name.</exception>
        public void SetBlendShapeWeight(string shape, float weight)
        {
            for (var i = 0; figure != null && i < figure.Levels.Count; i++)
            {
                var level = figure.Levels[i];
                var place = level.mesh.GetBlendShapeIndex(shape);
                if (place < 0)
                {
                    throw new ArgumentException("LOD" + level.lod + " has no blend shape \"" + shape + "\"", "shape");
                }
                level.renderer.SetBlendShapeWeight(place, weight);
            }
        }

        /// <summary>Who hears of the next person is to be told anew: for characters that are used again.</summary>
        internal void Forget()
        {
            OnReport = null;
        }

        /// <summary>
        /// Makes it a character whose meshes and avatar are assets: it owns them no longer, is saved as it stands, and is
        /// not generated when it awakes.
        /// </summary>
        internal void Bake()
        {
            if (figure == null)
            {
                throw new InvalidOperationException("the character has to be generated before it is baked");
            }
            turns++;
            figure.Bake();
            figure = null;
            baked = true;
            generateOnAwake = false;
            Release();
        }

        void OnDestroy()
        {
            Release();
        }

        /// <summary>Frees what is its own and no object. Unity calls `OnDestroy` of none that never was awake: who destroys
        /// such a one calls this before.</summary>
        internal void Release()
        {
            turns++;
            if (half != null)
            {
                half.Drop();
                half = null;
            }
            if (figure != null)
            {
                figure.Drop();
                figure = null;
            }
            if (body != null)
            {
                body.Dispose();
                body = null;
            }
        }
    }
}
