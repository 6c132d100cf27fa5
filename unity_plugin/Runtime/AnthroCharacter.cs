using System;
using System.Collections;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// A person in the scene, generated from a request: skeleton, one mesh per level of detail, humanoid avatar.
    /// Generating again updates it in place: GameObjects, transforms and meshes are kept. In edit mode generated objects
    /// are not saved with the scene but generated again when the scene opens. A duplicate generates itself from the
    /// request, even if the original got its body by `SetBody`.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Character")]
    [DisallowMultipleComponent]
    [ExecuteAlways]
    public sealed class AnthroCharacter : MonoBehaviour
    {
        [SerializeField] AnthroRequest request = new AnthroRequest();
        [Tooltip("A request asset to use instead of the character's own request.")]
        [SerializeField] AnthroRequestAsset requestAsset = null;
        [Tooltip("Finest level of detail, 0 to 3. Takes effect when the character is generated for the first time.")]
        [SerializeField] [Range(0, 3)] int finestLod = 0;
        [Tooltip("Coarsest level of detail, 0 to 3. Takes effect when the character is generated for the first time.")]
        [SerializeField] [Range(0, 3)] int coarsestLod = 3;
        [Tooltip("Skin tone on the Monk scale, 1 to 10; 0 for the default.")]
        [SerializeField] [Range(0, 10)] int skinTone = 0;
        [Tooltip("Leaves out eyes, teeth, tongue and eyelashes.")]
        [SerializeField] bool bodyOnly = false;
        [Tooltip("Builds a humanoid avatar.")]
        [SerializeField] bool humanoid = true;
        [Tooltip("Generates the character when it awakes.")]
        [SerializeField] bool generateOnAwake = true;
        [Tooltip("Materials that replace the default ones, by mesh part; empty entries get the default.")]
        [SerializeField] Material[] materials = new Material[0];

        // Serialised to survive domain reloads and duplication: a duplicate's `made` are its own children, but `owned`
        // are the original's.
        [SerializeField] [HideInInspector] List<GameObject> made = new List<GameObject>();
        [SerializeField] [HideInInspector] List<UnityEngine.Object> owned = new List<UnityEngine.Object>();
        [SerializeField] [HideInInspector] int owner;
        [SerializeField] [HideInInspector] bool baked;

        AnthroBody body;
        AnthroFigure figure;
        AnthroFigure pending;
        int latestTurn;

        /// <summary>Raised on the main thread after the character got a new body, which the character owns.</summary>
        public event Action<AnthroBody> OnGenerated;

        /// <summary>The person to generate; changes take effect with `Generate`. With a request asset it is that asset's
        /// request; setting a request detaches the asset.</summary>
        public AnthroRequest Request
        {
            get { return requestAsset != null ? requestAsset.Request : request; }
            set
            {
                requestAsset = null;
                request = value ?? new AnthroRequest();
            }
        }

        /// <summary>A request asset to use instead of the character's own request; null for none.</summary>
        public AnthroRequestAsset RequestAsset
        {
            get { return requestAsset; }
            set { requestAsset = value; }
        }

        /// <summary>The current body; null before the character is generated, and if it is baked. The character owns it
        /// and disposes it when it gets another body or is destroyed.</summary>
        public AnthroBody Body
        {
            get { return body; }
        }

        /// <summary>The skeleton; null before the character is generated, and if it is baked.</summary>
        public AnthroRig Rig
        {
            get { return figure == null ? null : figure.Rig; }
        }

        /// <summary>The humanoid avatar; null if it has none.</summary>
        public Avatar Avatar
        {
            get { return figure == null ? null : figure.Avatar; }
        }

        /// <summary>Whether meshes and avatar are saved assets. A baked character is not generated in `Awake`; `Generate`
        /// turns it back into a generated one.</summary>
        public bool IsBaked
        {
            get { return baked; }
        }

        /// <summary>Finest level of detail, 0 to 3. Takes effect with the first `Generate`.</summary>
        public int FinestLod
        {
            get { return finestLod; }
            set { finestLod = Mathf.Clamp(value, 0, 3); }
        }

        /// <summary>Coarsest level of detail, 0 to 3. Takes effect with the first `Generate`.</summary>
        public int CoarsestLod
        {
            get { return coarsestLod; }
            set { coarsestLod = Mathf.Clamp(value, 0, 3); }
        }

        /// <summary>Skin tone on the Monk scale, 1 to 10; 0 for the default. Takes effect with `Generate`.</summary>
        public int SkinTone
        {
            get { return skinTone; }
            set { skinTone = Mathf.Clamp(value, 0, 10); }
        }

        /// <summary>Leaves out eyes, teeth, tongue and eyelashes. Takes effect with `Generate`.</summary>
        public bool BodyOnly
        {
            get { return bodyOnly; }
            set { bodyOnly = value; }
        }

        /// <summary>Builds a humanoid avatar. Takes effect with `Generate`.</summary>
        public bool Humanoid
        {
            get { return humanoid; }
            set { humanoid = value; }
        }

        /// <summary>Generates the character in `Awake`.</summary>
        public bool GenerateOnAwake
        {
            get { return generateOnAwake; }
            set { generateOnAwake = value; }
        }

        /// <summary>Materials that replace the default ones, by mesh part; null entries get the default.</summary>
        public Material[] Materials
        {
            get { return materials; }
            set { materials = value ?? new Material[0]; }
        }

        /// <summary>The mesh of a level of detail; null if there is no such level.</summary>
        public Mesh GetMesh(int lod)
        {
            var level = LevelOf(lod);
            return level == null ? null : level.mesh;
        }

        /// <summary>The renderer of a level of detail; null if there is no such level.</summary>
        public SkinnedMeshRenderer GetRenderer(int lod)
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
            // Unity calls `OnEnable` next on an enabled component; generating there alone reports an error once, not
            // twice.
            if (!enabled)
            {
                GenerateIfNeeded();
            }
        }

        // The only message that Unity sends after a domain reload.
        void OnEnable()
        {
            GenerateIfNeeded();
        }

        /// <summary>Generates the character if it has no body but should have one: on `Awake` if enabled, and always if
        /// it had been generated before a domain reload or duplication. Logs exceptions, since Unity's messages have no
        /// caller to catch them.
        /// </summary>
        void GenerateIfNeeded()
        {
            if (body != null && body.IsFreed)
            {
                // Released before a domain reload that then did not take place.
                body = null;
            }
            if (baked || body != null || pending != null || !(generateOnAwake || made.Exists(child => child != null)))
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

        /// <summary>Generates the person that the request describes, synchronously.</summary>
        /// <exception cref="AnthroException">The request is refused; the character is unchanged.</exception>
        public void Generate()
        {
            SetBody(AnthroModel.Default.Generate(Request));
        }

        /// <summary>Gives the character a body, synchronously. The character owns the body from now on.</summary>
        public void SetBody(AnthroBody newBody)
        {
            for (var steps = SetBodyInSteps(newBody); steps.MoveNext();)
            {
            }
        }

        /// <summary>
        /// As `SetBody`, as a coroutine in steps of a few milliseconds. Until the last step the character keeps its
        /// previous body, or stays invisible if it had none; if the steps are abandoned, it stays so. A later `SetBody`
        /// cancels an unfinished one.
        /// </summary>
        public IEnumerator SetBodyInSteps(AnthroBody newBody)
        {
            Native.Library.NotNull(newBody, "newBody");
            return SetBodySteps(new AnthroBuild(newBody, skinTone, bodyOnly));
        }

        /// <summary>As `SetBodyInSteps`, for a build that may be packed already. Takes ownership of body and
        /// build.</summary>
        internal IEnumerator SetBodySteps(AnthroBuild build)
        {
            var turn = ++latestTurn;
            var next = build.Body;
            var done = false;
            try
            {
                var lods = Lods();
                var complete = figure == null || figure.BodyOnly != build.BodyOnly;
                foreach (var lod in lods)
                {
                    if (build.Pack(lod, complete))
                    {
                        yield return null;
                    }
                    if (turn != latestTurn || this == null)
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
                    BeginFigure();
                    for (var steps = pending.Make(build, lods, humanoid); steps.MoveNext();)
                    {
                        yield return null;
                        if (turn != latestTurn || this == null)
                        {
                            yield break;
                        }
                    }
                    figure = pending;
                    pending = null;
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
            if (OnGenerated != null)
            {
                OnGenerated(body);
            }
        }

        /// <summary>Starts a new figure; an unfinished one is discarded.</summary>
        void BeginFigure()
        {
            if (pending != null)
            {
                pending.DestroyOwned();
            }
            if (owner == GetInstanceID())
            {
                // What it owned before a domain reload. If this is a duplicate, the list holds the original's objects,
                // which stay.
                owned.ForEach(AnthroObjects.DestroySafely);
            }
            owned.Clear();
            owner = GetInstanceID();
            if (baked)
            {
                baked = false;
                // The saved assets stay in the project, and the generated meshes that replace them are not saved with the
                // scene.
                generateOnAwake = true;
            }
            pending = new AnthroFigure(this, made, owned);
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
        /// Adds a blend shape that leads to another body's surface, such as a heavier one, to all levels of detail; its
        /// weight ranges from 0 to 100. Blend shapes are removed when the character gets another body.
        /// </summary>
        public void AddBlendShape(string name, AnthroBody target)
        {
            if (body == null)
            {
                throw new InvalidOperationException("the character is not generated yet: blend shapes need its meshes");
            }
            foreach (var level in figure.Levels)
            {
                using (var mesh = new AnthroMesh(body, level.lod, skinTone, figure.BodyOnly))
                {
                    mesh.AddBlendShape(name, target);
                    AnthroMeshes.AddBlendShapes(level.mesh, mesh);
                }
            }
        }

        /// <summary>Removes all blend shapes; Unity cannot remove a single one.</summary>
        public void ClearBlendShapes()
        {
            for (var i = 0; figure != null && i < figure.Levels.Count; i++)
            {
                figure.Levels[i].mesh.ClearBlendShapes();
            }
        }

        internal bool HasBlendShape(string name)
        {
            return figure != null && figure.Levels.TrueForAll(level => level.mesh.GetBlendShapeIndex(name) >= 0);
        }

        /// <summary>Sets the weight of a blend shape, 0 to 100, on all levels of detail. Allocates no managed
        /// memory.</summary>
        /// <exception cref="ArgumentException">There is no blend shape of this name.</exception>
        public void SetBlendShapeWeight(string name, float weight)
        {
            for (var i = 0; figure != null && i < figure.Levels.Count; i++)
            {
                var level = figure.Levels[i];
                var place = level.mesh.GetBlendShapeIndex(name);
                if (place < 0)
                {
                    throw new ArgumentException("LOD" + level.lod + " has no blend shape \"" + name + "\"", "name");
                }
                level.renderer.SetBlendShapeWeight(place, weight);
            }
        }

        /// <summary>Removes all handlers of events: for pooled characters.</summary>
        internal void ClearListeners()
        {
            OnGenerated = null;
        }

        /// <summary>
        /// Turns it into a baked character, whose meshes and avatar are assets: it no longer owns them, is saved as it
        /// is, and is not generated in `Awake`.
        /// </summary>
        internal void Bake()
        {
            if (figure == null)
            {
                throw new InvalidOperationException("the character is not generated yet: there is nothing to bake");
            }
            latestTurn++;
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

        /// <summary>Destroys the owned meshes, avatar and body. Unity sends no `OnDestroy` to a component that never was
        /// active: whoever destroys such a character calls this first.</summary>
        internal void Release()
        {
            latestTurn++;
            if (pending != null)
            {
                pending.DestroyOwned();
                pending = null;
            }
            if (figure != null)
            {
                figure.DestroyOwned();
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
