using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Plays an AnthroNet clip on a character: sampled natively every frame, without allocating managed memory. It runs
    /// after the `Animator` and overrides its pose. When the character gets another body, a built-in clip is retargeted
    /// to it and continues at the same time; a clip passed to `Play` by the caller stays as it is.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Animator")]
    [DisallowMultipleComponent]
    public sealed class AnthroAnimator : AnthroCharacterBehaviour
    {
        [Tooltip("Name of the built-in clip that plays, such as walk; empty for none.")]
        [SerializeField] string builtin = "";
        [Tooltip("Playback speed: 1 is the clip's own, negative values play backwards.")]
        [SerializeField] float speed = 1f;
        [Tooltip("What happens outside the clip's duration: hold, loop, or loop with accumulating root motion.")]
        [SerializeField] AnthroWrap wrap = AnthroWrap.Loop;
        // Serialised so that playback continues after a domain reload.
        [SerializeField] [HideInInspector] double time;

        AnthroClip clip;
        AnthroBody madeFor;
        bool own;
        AnthroTransform[] pose;
        AnthroContext context;

        /// <summary>The playing clip; null if none.</summary>
        public AnthroClip Clip
        {
            get { return clip; }
        }

        /// <summary>Seconds since the clip's first frame.</summary>
        public double Time
        {
            get { return time; }
            set { time = value; }
        }

        /// <summary>Playback speed, clip seconds per second; negative values play backwards.</summary>
        public float Speed
        {
            get { return speed; }
            set { speed = value; }
        }

        /// <summary>What happens outside the clip's duration.</summary>
        public AnthroWrap Wrap
        {
            get { return wrap; }
            set { wrap = value; }
        }

        /// <summary>Plays a clip from the start; null stops playback. The caller keeps ownership of the clip, which may
        /// play on many characters.</summary>
        public void Play(AnthroClip next)
        {
            Use(next);
            builtin = "";
            time = 0.0;
        }

        /// <summary>Plays a built-in clip, such as `walk`, made for this character's body.</summary>
        /// <exception cref="AnthroException">There is no built-in clip of this name.</exception>
        /// <exception cref="System.InvalidOperationException">The character is not generated yet.</exception>
        public void Play(string name)
        {
            Make(name);
            builtin = name;
            time = 0.0;
        }

        void Make(string name)
        {
            var body = RequireBody();
            Use(AnthroClip.Builtin(name, body));
            madeFor = body;
            own = true;
        }

        void Use(AnthroClip next)
        {
            Release();
            clip = next;
            if (clip != null && (pose == null || pose.Length != clip.JointCount))
            {
                pose = new AnthroTransform[clip.JointCount];
            }
            if (clip != null && context == null)
            {
                context = new AnthroContext();
            }
        }

        /// <summary>Remakes a built-in clip for the character's new body; playback continues at the same time.</summary>
        internal override void OnBody(AnthroBody body)
        {
            if (!string.IsNullOrEmpty(builtin) && !ReferenceEquals(madeFor, body))
            {
                Make(builtin);
            }
            if (clip != null)
            {
                Advance(0f);
            }
        }

        // After Unity's own animation system, which may write to the same transforms.
        void LateUpdate()
        {
            Advance(UnityEngine.Time.deltaTime);
        }

        /// <summary>Advances the time and poses the character. `LateUpdate` calls it every frame.</summary>
        public void Advance(float seconds)
        {
            if (clip == null || Character.Rig == null)
            {
                return;
            }
            time += (double)speed * seconds;
            clip.Sample(time, wrap, pose, false, context);
            Character.Rig.ApplyPose(pose);
        }

        void OnDestroy()
        {
            Release();
            clip = null;
            if (context != null)
            {
                context.Dispose();
                context = null;
            }
        }

        void Release()
        {
            if (own)
            {
                clip.Dispose();
            }
            own = false;
            madeFor = null;
        }
    }
}
