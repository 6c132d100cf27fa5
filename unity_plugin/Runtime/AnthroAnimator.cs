using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Plays a clip of ours on a character: sampled natively each frame, without garbage. Where the character has an
    /// `Animator` with a controller, it wins over it. A built-in clip is made anew when the character becomes another
    /// body, and goes on at the same time; a clip of the caller's plays on as it is.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Animator")]
    [DisallowMultipleComponent]
    public sealed class AnthroAnimator : AnthroCharacterBehaviour
    {
        [SerializeField] string builtin = "";
        [SerializeField] float speed = 1f;
        [SerializeField] AnthroWrap wrap = AnthroWrap.Loop;
        // Goes on here after the code was loaded anew.
        [SerializeField] [HideInInspector] double time;

        AnthroClip clip;
        AnthroBody madeFor;
        bool own;
        AnthroTransform[] pose;

        /// <summary>The clip that plays; null where none does.</summary>
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

        /// <summary>Seconds of the clip per second; negative ones go backwards.</summary>
        public float Speed
        {
            get { return speed; }
            set { speed = value; }
        }

        /// <summary>What the clip is outside its duration.</summary>
        public AnthroWrap Wrap
        {
            get { return wrap; }
            set { wrap = value; }
        }

        /// <summary>Plays a clip from its beginning; null stops. The clip stays the caller's: it may play on many characters.
        /// </summary>
        public void Play(AnthroClip next)
        {
            Use(next);
            builtin = "";
            time = 0.0;
        }

        /// <summary>Plays a built-in clip, such as `walk`, made for this character.</summary>
        /// <exception cref="AnthroException">There is none of that name.</exception>
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
        }

        /// <summary>Makes a clip of its own for the body that the character is now, at the same time.</summary>
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

        // After Unity's own animation, which may write to the same transforms.
        void LateUpdate()
        {
            Advance(UnityEngine.Time.deltaTime);
        }

        /// <summary>Goes on by seconds and poses the character. `LateUpdate` does it each frame.</summary>
        public void Advance(float seconds)
        {
            if (clip == null || Character.Rig == null)
            {
                return;
            }
            time += (double)speed * seconds;
            clip.Sample(time, wrap, pose);
            Character.Rig.ToPose(pose);
        }

        void OnDestroy()
        {
            Release();
            clip = null;
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
