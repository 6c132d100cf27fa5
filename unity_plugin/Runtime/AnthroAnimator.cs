using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Plays a clip of ours on a character: sampled natively each frame, without garbage. Where the character has an
    /// `Animator` with a controller, it wins over it.
    /// </summary>
    [AddComponentMenu("AnthroNet/AnthroNet Animator")]
    [RequireComponent(typeof(AnthroCharacter))]
    public sealed class AnthroAnimator : MonoBehaviour
    {
        [SerializeField] string builtin = "";
        [SerializeField] float speed = 1f;
        [SerializeField] AnthroWrap wrap = AnthroWrap.Loop;

        AnthroCharacter character;
        AnthroClip clip;
        bool own;
        AnthroTransform[] pose;

        /// <summary>The clip that plays; null where none does.</summary>
        public AnthroClip Clip
        {
            get { return clip; }
        }

        /// <summary>Seconds since the clip's first frame.</summary>
        public double Time { get; set; }

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
            Release();
            clip = next;
            Time = 0.0;
            if (clip != null && (pose == null || pose.Length != clip.JointCount))
            {
                pose = new AnthroTransform[clip.JointCount];
            }
        }

        /// <summary>Plays a built-in clip, such as `walk`, made for this character.</summary>
        public void Play(string name)
        {
            Play(AnthroClip.Builtin(name, GetComponent<AnthroCharacter>().Body));
            own = true;
        }

        void Start()
        {
            if (clip == null && !string.IsNullOrEmpty(builtin) && GetComponent<AnthroCharacter>().Body != null)
            {
                Play(builtin);
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
            if (character == null)
            {
                character = GetComponent<AnthroCharacter>();
            }
            if (clip == null || character.Rig == null)
            {
                return;
            }
            Time += (double)speed * seconds;
            clip.Sample(Time, wrap, pose);
            character.Rig.ToPose(pose);
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
                own = false;
            }
        }
    }
}
